// swingbank inventory: lists the units of a PSS/E, PSLF or MATPOWER case and the models that Swingbank does
// not cover.
#include "sim/grid/inventory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "base/json.hpp"
#include "jobs/command_line.hpp"

namespace swingbank::jobs::inventory_command {
namespace {

using Json = nlohmann::ordered_json;
using sim::grid::Inventory;
using sim::grid::ModelCount;
using sim::grid::UnitCount;

struct Arguments {
  std::filesystem::path raw, dyr;
  std::optional<double> frequency_hz;
  int raw_version = 0;
  bool units = false, json = false;
};

struct Totals {
  int units = 0, covered = 0, without_machine = 0, partly = 0, off = 0, classical = 0, idle = 0;
};
Totals totals_of(const Inventory& inventory) {
  Totals t;
  for (const UnitCount& u : inventory.units) {
    ++t.units;
    t.covered += u.covered() ? 1 : 0;
    t.without_machine += u.models.empty() ? 1 : 0;
    t.partly += !u.covered() && !u.models.empty() ? 1 : 0;
    t.off += u.in_service ? 0 : 1;
    t.classical += u.classical ? 1 : 0;
    t.idle += u.classical ? u.field_records : 0;
  }
  return t;
}

std::string state_of(const UnitCount& u) {
  if (u.covered()) return "covered";
  if (u.models.empty()) return "no dynamic model";
  if (u.uncovered.empty()) return "no machine model";
  return fmt::format("not covered: {}", fmt::join(u.uncovered, ", "));
}

void print_models(const Inventory& inventory) {
  fmt::print("\n{:<12} {:>8} {:>8} {:>8}  {}\n", "model", "records", "units", "line", "covered");
  for (const ModelCount& m : inventory.models) {
    const std::string covered = m.kind.empty()  ? "no"
                                : m.faulty == 0 ? "yes, " + m.kind
                                                : fmt::format("all but {}, {}", m.faulty, m.kind);
    fmt::print("{:<12} {:>8} {:>8} {:>8}  {}\n", m.name, m.records, m.units, m.first_line, covered);
  }
}

/// Prints the problems, grouped by text. Problems in a group differ only in place and numbers.
void print_faults(const char* title, const std::vector<std::string>& faults) {
  std::map<std::string, std::pair<int, std::string>> groups;
  for (const auto& fault : faults) {
    std::string kind;
    for (const char c : fault.substr(fault.find(" (") == std::string::npos ? 0 : fault.find(" (")))
      if (!std::isdigit(static_cast<unsigned char>(c))) kind += c;
    auto& [count, first] = groups[kind];
    if (++count == 1) first = fault;
  }
  if (!groups.empty()) fmt::print("\n{}\n", title);
  for (const auto& [kind, group] : groups)
    fmt::print("  {} x {}{}\n", group.first, group.first > 1 ? "for example: " : "", group.second);
}

void print_text(const Inventory& inventory, bool units) {
  const Totals t = totals_of(inventory);
  const auto share = [&](int n) { return t.units == 0 ? 0.0 : 100.0 * n / t.units; };
  fmt::print(
      "{} units: {} fully covered ({:.1f} %), {} partly, {} without a dynamic model; {} out of service\n",
      t.units, t.covered, share(t.covered), t.partly, t.without_machine, t.off);
  if (t.classical > 0)
    fmt::print(
        "{} units are classical machines (GENCLS){}\n", t.classical,
        t.idle == 0
            ? std::string()
            : fmt::format(": {} records of exciters, stabilisers and other controls have no effect there",
                          t.idle));
  print_models(inventory);
  for (const ModelCount& m : inventory.models)
    if (m.faulty > 0) fmt::print("\n{} x {}, for example: {}\n", m.faulty, m.name, m.fault);
  if (inventory.without_generator > 0)
    fmt::print("\n{} records of generators that the .raw does not have, the first on line {}\n",
               inventory.without_generator, inventory.first_without_generator);
  print_faults("faults of the .raw", inventory.raw_faults);
  print_faults("faults of the .dyr", inventory.dyr_faults);
  if (!units) return;
  fmt::print("\n{:>8} {:<3} {:<14} {:>10}  {:<12} {}\n", "bus", "id", "name", "MVA", "", "models");
  for (const UnitCount& u : inventory.units)
    fmt::print("{:>8} {:<3} {:<14} {:>10g}  {:<12} {}; {}\n", u.bus, u.id, u.bus_name, u.mva,
               u.in_service ? "" : "out", fmt::join(u.models, " "), state_of(u));
}

void print_json(const Inventory& inventory) {
  const Totals t = totals_of(inventory);
  Json j = {{"format", "swingbank-inventory-1"},
            {"units", t.units},
            {"covered", t.covered},
            {"in_part", t.partly},
            {"without_model", t.without_machine},
            {"out_of_service", t.off},
            {"classical", t.classical},
            {"idle_records", t.idle},
            {"records_without_generator", inventory.without_generator},
            {"models", Json::array()},
            {"list", Json::array()},
            {"raw_faults", inventory.raw_faults},
            {"dyr_faults", inventory.dyr_faults}};
  for (const ModelCount& m : inventory.models)
    j["models"].push_back({{"name", m.name},
                           {"kind", m.kind},
                           {"records", m.records},
                           {"units", m.units},
                           {"first_line", m.first_line},
                           {"not_covered", m.uncovered()}});
  for (const UnitCount& u : inventory.units)
    j["list"].push_back({{"bus", u.bus},
                         {"id", u.id},
                         {"name", u.bus_name},
                         {"mva", u.mva},
                         {"in_service", u.in_service},
                         {"covered", u.covered()},
                         {"models", u.models},
                         {"not_covered", u.uncovered}});
  fmt::print("{}\n", j.dump(1));
}

}  // namespace

int run(CommandLine& line, int argc, char** argv) {
  Arguments a;
  line.add("--raw,--epc", a.raw,
           "network, format by file extension: PSS/E .raw or .rawx, PSLF .epc, MATPOWER .m")
      .required();
  line.add("--dyr,--dyd", a.dyr, "dynamic models, format by file extension: PSS/E .dyr, PSLF .dyd")
      .required();
  line.add("--frequency-hz", a.frequency_hz,
           "nominal frequency [Hz]: accepted for consistency with other commands; not used");
  line.add("--raw-version", a.raw_version, "version of a .raw file without a version number, 23 to 35");
  line.add_flag("--units", a.units, "list every unit with its models");
  line.add_flag("--json", a.json, "print everything as JSON");
  line.footer(
      "A unit is fully covered if it has a machine model and every record of it can be read; 'swingbank plant' "
      "writes a unit as a plant file.");
  line.example("swingbank inventory --raw grid.raw --dyr grid.dyr");
  if (!line.parse(argc, argv)) return line.end();
  const Inventory inventory = sim::grid::take_inventory(a.raw, a.dyr, {a.frequency_hz, a.raw_version});
  a.json ? print_json(inventory) : print_text(inventory, a.units);
  return 0;
}

}  // namespace swingbank::jobs::inventory_command
