// Construction of a grid from the files of a case, in any supported format.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <string>
#include <vector>

#include "sim/formats/dyd.hpp"
#include "sim/formats/matpower.hpp"
#include "sim/grid/grid.hpp"

namespace swingbank::sim::grid {

std::string remark_line(const network::Remark& remark, std::size_t places) {
  std::string text = remark.what;
  if (remark.places.size() > 1) text += fmt::format(" ({} times)", remark.places.size());
  for (std::size_t i = 0; i < remark.places.size() && i < places; ++i)
    text += (i ? "; " : ": ") + remark.places[i];
  if (remark.places.size() > places) text += fmt::format("; and {} more", remark.places.size() - places);
  return text;
}

namespace {

/// Copies the machine data that PSLF keeps in the .dyd and PSS/E in the .raw.
void take_machines(network::Network& network, const formats::DydSurvey& dyd, const std::string& name) {
  for (const formats::DyrRecord& record : dyd.dyr.records) {
    const std::string where = name + ":" + std::to_string(record.line);
    if (const auto note = dyd.notes.find(record.line); note != dyd.notes.end())
      network.remark("values of the .dyd on their own rating are converted to the machine's base",
                     note->second);
    const auto machine = dyd.machines.find(record.line);
    if (machine == dyd.machines.end()) continue;
    const auto g = std::ranges::find_if(network.generators, [&](const network::Generator& other) {
      return network.buses[static_cast<std::size_t>(other.bus)].number == record.bus && other.id == record.id;
    });
    if (g == network.generators.end()) continue;  // make_grid drops the record with a remark
    g->zr = machine->second.resistance;
    g->zx = machine->second.reactance.value_or(0);  // 0: no value to compare with
    if (machine->second.mva == g->mva || !(machine->second.mva > 0)) continue;
    network.remark("machine bases differ between the .dyd and the network; the .dyd is used",
                   fmt::format("'{}' at bus {}: {:g} MVA, not {:g} ({})", record.id, record.bus,
                               machine->second.mva, g->mva, where));
    g->rt *= machine->second.mva / g->mva;
    g->xt *= machine->second.mva / g->mva;
    g->mva = machine->second.mva;
  }
  for (const auto& [model, count] : dyd.passed_over)
    network.remark("records of the .dyd were skipped", fmt::format("{} {}", count, model));
}

}  // namespace

Grid load_grid(const std::filesystem::path& raw, const std::filesystem::path& dyr, Conventions conventions,
               const CaseOptions& options) {
  formats::refuse_exchanged(raw, dyr);
  Problems problems;
  network::Network network;
  std::vector<formats::DyrRecord> dynamics;
  const auto collect = [&](const auto& read) {
    try {
      read();
    } catch (const InputError& error) {
      problems.add(error);
    }
  };
  collect([&] { network = formats::read_network(raw, options.raw); });
  formats::DydSurvey dyd;
  collect([&] {
    if (formats::is_dyd(dyr)) {
      dyd = formats::survey_dyd(dyr);
      dynamics = formats::chosen_records(dyd, dyr.string(), options.dyr);
    } else {
      dynamics = formats::read_dyr(dyr, options.dyr);
    }
  });
  problems.raise();
  take_machines(network, dyd, dyr.string());
  Grid grid = make_grid(std::move(network), dynamics, dyr.string(), conventions, options);
  constexpr std::size_t places = 4;  // places shown, to fit on a screen; `simulate --changes` writes all
  for (const network::Remark& remark : grid.network.remarks)
    spdlog::warn("{}: {}", raw.filename().string(), remark_line(remark, places));
  return grid;
}

Grid load_grid(const std::filesystem::path& raw, const std::filesystem::path& dyr, Conventions conventions,
               const formats::DyrOptions& options, std::optional<double> frequency_hz) {
  CaseOptions all;
  all.dyr = options;
  all.raw.frequency_hz = frequency_hz;
  return load_grid(raw, dyr, conventions, all);
}

}  // namespace swingbank::sim::grid
