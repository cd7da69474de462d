// Python's Grid and Run: events on a grid by the reference integrator.
#include <fmt/format.h>

#include <algorithm>

#include "python/src/interruptible.hpp"
#include "python/src/native.hpp"
#include "sim/formats/event_text.hpp"
#include "sim/grid/attach.hpp"
#include "sim/grid/event_choice.hpp"
#include "sim/grid/limits.hpp"
#include "sim/grid/load_choice.hpp"
#include "sim/reference/reference.hpp"
#include "sim/user_models/user_model.hpp"
#include "validate/report/plot.hpp"

namespace swingbank::python {
namespace {

using sim::grid::EventTexts, sim::grid::Grid;
using Path = std::filesystem::path;
using Words = std::vector<std::string>;

/// Samples of one simulated event, with the names of the plants.
struct Run {
  sim::reference::ReferenceRun samples;
  Words plants;
  std::vector<double> bases;  ///< machine base of each plant [MVA]
  std::vector<int> buses;     ///< bus numbers
};

/// Simulation options other than the event.
struct RunOptions {
  double t_end = 15, rate = 120, tolerance = 1e-8;
  Words plants, channels;
  std::vector<int> buses;
  bool after_switching = false;
};

sim::Conventions conventions_of(const std::string& name) {
  if (name == "psse") return sim::Conventions::psse();
  if (name == "andes") return sim::Conventions::andes();
  throw InputError(
      {"convention '" + name + "'", "convention", "there is no such convention", "choose psse or andes"});
}

std::shared_ptr<Grid> load(const Path& raw, const Path& dyr, const std::string& convention,
                           std::optional<double> frequency_hz, const Words& attach, const Words& loads,
                           const std::vector<Path>& user_models, bool loads_as_composed) {
  return without_lock([&] {
    auto grid = std::make_shared<Grid>(
        sim::grid::load_grid(raw, dyr, conventions_of(convention), sim::formats::DyrOptions{}, frequency_hz));
    for (const Path& file : user_models) sim::user_models::load_user_model(file, grid->library);
    Problems problems;
    for (const auto& text : attach) sim::grid::attach(*grid, text, "attach " + text, problems);
    if (loads_as_composed) sim::grid::loads_as_composed(*grid, problems);
    for (const auto& text : loads) sim::grid::choose_load(*grid, text, "load " + text, problems);
    problems.raise();
    sim::grid::settle_limits(*grid, false);
    return grid;
  });
}

/// Returns, for messages, the argument and the value that define a part of an event: "faults 4:2:2.1".
std::string place_of(sim::grid::EventPart part, const std::string& text) {
  static constexpr const char* kArguments[] = {"faults",     "trips",      "generator_trips", "load_steps",
                                               "vref_steps", "pref_steps", "fault_type",      "z0"};
  return kArguments[static_cast<int>(part)] + (text.empty() ? "" : " " + text);
}

Words names_of(const Grid& grid) {
  Words names;
  for (const auto& p : grid.plants) names.push_back(p.name);
  return names;
}

std::vector<int> plants_of(const Grid& grid, const Words& names, Problems& problems) {
  std::vector<int> all;
  for (const auto& name : names) {
    const auto found = std::ranges::find(grid.plants, name, &sim::plant::Plant::name);
    if (found == grid.plants.end())
      problems.add("no plant " + name, "plants",
                   fmt::format("the plants are {}", fmt::join(names_of(grid), ", ")),
                   "choose one or more of these");
    all.push_back(static_cast<int>(found - grid.plants.begin()));
  }
  return all;
}

std::vector<sim::Channel> channels_of(const Words& names, Problems& problems) {
  std::vector<sim::Channel> all;
  std::string known;
  for (const auto& c : sim::kChannels) known += (known.empty() ? "" : ", ") + std::string(c.name);
  for (const auto& name : names) {
    if (const auto* record = sim::find_channel(name))
      all.push_back(record->channel);
    else
      problems.add("no channel " + name, "channels", "the channels are " + known,
                   "choose one or more of these");
  }
  return all;
}

void check_positive(double value, const char* name, const char* unit, Problems& problems) {
  if (!(value > 0) || !std::isfinite(value))
    problems.add(fmt::format("{} = {} {}", name, value, unit), name, "it must be positive",
                 "give a positive number");
}

sim::reference::ReferenceOptions options_of(const Grid& grid, const RunOptions& asked, Problems& problems) {
  check_positive(asked.t_end, "t_end", "s", problems);
  check_positive(asked.rate, "rate", "1/s", problems);
  check_positive(asked.tolerance, "tolerance", "(relative)", problems);
  sim::reference::ReferenceOptions options;
  options.t_end = asked.t_end;
  options.rate = asked.rate;
  options.rtol = asked.tolerance;
  options.atol = asked.tolerance / 100;
  options.after_switching = asked.after_switching;
  options.plants = plants_of(grid, asked.plants, problems);
  options.channels = channels_of(asked.channels, problems);
  for (const int bus : asked.buses)
    options.buses.push_back(sim::formats::read_bus(std::to_string(bus), grid.network, "buses", problems));
  return options;
}

std::shared_ptr<Run> run(const Grid& grid, const EventTexts& texts, const RunOptions& asked) {
  Problems problems;
  const auto event = sim::grid::read_event(texts, grid, asked.t_end, place_of, problems);
  const auto options = options_of(grid, asked, problems);
  problems.raise();
  auto result = std::make_shared<Run>();
  result->samples = sim::reference::run_reference(grid, event, options);
  result->buses = asked.buses;
  for (const int p : result->samples.plants) {
    result->plants.push_back(grid.plants[static_cast<std::size_t>(p)].name);
    result->bases.push_back(grid.plants[static_cast<std::size_t>(p)].mva);
  }
  return result;
}

std::vector<double> times(const Run& r) {
  std::vector<double> t(static_cast<std::size_t>(r.samples.samples));
  for (std::size_t k = 0; k < t.size(); ++k) t[k] = static_cast<double>(k) / r.samples.rate;
  return t;
}

Words channel_names(const Run& r) {
  Words names;
  for (const sim::Channel c : r.samples.channels)
    names.emplace_back(sim::kChannels[static_cast<std::size_t>(c)].name);
  return names;
}

py::dict units(const Run& r) {
  py::dict all;
  for (const sim::Channel c : r.samples.channels) {
    const auto& record = sim::kChannels[static_cast<std::size_t>(c)];
    all[py::str(std::string(record.name))] = std::string(record.unit);
  }
  return all;
}

py::array_t<double> values(const Run& r) {
  py::array_t<double> all(
      {r.samples.plants.size(), r.samples.channels.size(), static_cast<std::size_t>(r.samples.samples)});
  std::ranges::copy(r.samples.packed(), all.mutable_data());
  return all;
}

std::vector<double> row_of(const Run& r, const std::string& plant, const std::string& channel) {
  const auto p = std::ranges::find(r.plants, plant) - r.plants.begin();
  const Words names = channel_names(r);
  const auto c = std::ranges::find(names, channel) - names.begin();
  if (p == std::ssize(r.plants)) throw py::key_error(plant);
  if (c == std::ssize(names)) throw py::key_error(channel);
  const double* from = r.samples.at(static_cast<int>(p), static_cast<int>(c));
  return {from, from + r.samples.samples};
}

std::string describe(const Run& r) {
  return fmt::format("{} at {:g} s{}", sim::outcome_name(r.samples.outcome), r.samples.stopped_at,
                     r.samples.lost_by.empty() ? "" : " (" + r.samples.lost_by + ")");
}

/// Returns a plot of one channel of all plants.
std::string html_of(const Run& r) {
  const std::vector<double> t = times(r);
  const Words names = channel_names(r);
  const std::string shown = std::ranges::count(names, "speed") > 0 ? "speed" : names.front();
  report::Plot plot;
  plot.title = shown;
  plot.x.label = "t [s]";
  plot.y.label = fmt::format("{} [{}]", shown, std::string(sim::find_channel(shown)->unit));
  const std::size_t every = 1 + t.size() / 1000;
  for (std::size_t p = 0; p < r.plants.size(); ++p) {
    report::PlotSeries s;
    s.name = r.plants[p];
    s.colour = report::plot_colour(p);
    s.mark = report::PlotSeries::Mark::none;
    s.line = true;
    const auto row = row_of(r, r.plants[p], shown);
    for (std::size_t k = 0; k < t.size(); k += every) s.points.emplace_back(t[k], row[k]);
    plot.series.push_back(std::move(s));
  }
  return "<div>" + verdict_html(describe(r), r.samples.outcome == sim::Outcome::stable) +
         report::svg({plot}) + "</div>";
}

void bind_run(py::module_& module) {
  py::class_<Run, std::shared_ptr<Run>>(module, "Run", "Samples of one simulated event.")
      .def_property_readonly(
          "t", [](const Run& r) { return array(times(r)); }, "Times, shape (samples,) [s].")
      .def_readonly("plants", &Run::plants, "Names of the recorded plants.")
      .def_readonly("bases", &Run::bases, "Bases of the recorded plants [MVA].")
      .def_property_readonly("channels", &channel_names, "Names of the recorded channels.")
      .def_property_readonly("units", &units, "Unit of each channel; pu is on the plant's own base.")
      .def_property_readonly("values", &values, "Shape (plants, channels, samples), in the channels' units.")
      .def_readonly("buses", &Run::buses, "Numbers of the recorded buses.")
      .def_property_readonly(
          "bus_voltage", [](const Run& r) { return matrix(r.samples.bus_v, r.buses.size()); },
          "Voltage magnitude, shape (buses, samples) [pu].")
      .def_property_readonly(
          "bus_angle", [](const Run& r) { return matrix(r.samples.bus_theta, r.buses.size()); },
          "Voltage angle, shape (buses, samples) [rad].")
      .def_property_readonly(
          "outcome", [](const Run& r) { return std::string(sim::outcome_name(r.samples.outcome)); },
          "\"stable\", \"lost_synchronism\", \"not_finite\" or \"step_too_small\".")
      .def_property_readonly(
          "stopped_at", [](const Run& r) { return r.samples.stopped_at; },
          "End of the simulation [s]; later samples repeat the last value.")
      .def(
          "__getitem__",
          [](const Run& r, const std::pair<std::string, std::string>& at) {
            return array(row_of(r, at.first, at.second));
          },
          py::arg("plant_and_channel"), "Returns run[\"2\", \"P\"], shape (samples,).")
      .def("_repr_html_", &html_of)
      .def("__repr__", [](const Run& r) { return "<swingbank.Run: " + describe(r) + ">"; });
}

void bind_grid(py::module_& module) {
  py::class_<Grid, std::shared_ptr<Grid>>(module, "Grid", "A grid with its power flow and dynamic models.")
      .def(
          py::init(&load), py::arg("network"), py::arg("dynamics"), py::kw_only(),
          py::arg("convention") = "psse", py::arg("frequency_hz") = py::none(), py::arg("attach") = Words{},
          py::arg("loads") = Words{}, py::arg("user_models") = std::vector<Path>{},
          py::arg("loads_as_composed") = false,
          "Reads a case (.raw, .rawx, .epc or .m with .dyr or .dyd) and solves its power flow.\n\n"
          "`convention`: \"psse\" or \"andes\"; `frequency_hz`: nominal frequency [Hz] if the network has\n"
          "none; `attach`: \"PLANT:EFFECT[:PARAM=VALUE,...]\"; `loads`: \"BUS[/ID]:EFFECT[:PARAM=VALUE,...]\";\n"
          "`loads_as_composed`: loads as the .raw composes them; otherwise constant impedances.")
      .def_property_readonly("plants", &names_of, "Names of the plants: bus number, or \"bus/id\".")
      .def("__repr__", [](const Grid& g) {
        return fmt::format("<swingbank.Grid: {} buses, {} plants>", g.network.buses.size(), g.plants.size());
      });
}

}  // namespace

void bind_simulation(py::module_& module) {
  bind_run(module);
  bind_grid(module);
  module.def(
      "simulate",
      [](const std::shared_ptr<Grid>& grid, const Words& faults, const Words& trips,
         const Words& generator_trips, const Words& load_steps, const Words& vref_steps,
         const Words& pref_steps, const std::string& fault_type, const std::string& z0, double t_end,
         double rate, const Words& plants, const Words& channels, const std::vector<int>& buses,
         double tolerance, bool after_switching) {
        const EventTexts texts{faults,     trips,      generator_trips, load_steps,
                               vref_steps, pref_steps, fault_type,      z0};
        const RunOptions options{t_end, rate, tolerance, plants, channels, buses, after_switching};
        return without_lock([&] { return run(*grid, texts, options); });
      },
      py::arg("grid"), py::kw_only(), py::arg("faults") = Words{}, py::arg("trips") = Words{},
      py::arg("generator_trips") = Words{}, py::arg("load_steps") = Words{}, py::arg("vref_steps") = Words{},
      py::arg("pref_steps") = Words{}, py::arg("fault_type") = "3ph", py::arg("z0") = "",
      py::arg("t_end") = 15.0, py::arg("rate") = 120.0, py::arg("plants") = Words{},
      py::arg("channels") = Words{}, py::arg("buses") = std::vector<int>{}, py::arg("tolerance") = 1e-8,
      py::arg("after_switching") = false,
      "Simulates an event by the reference integrator, as `swingbank simulate` does.\n\n"
      "Events are texts as for the command: `faults` \"BUS:T_ON:T_OFF[:R:X]\", `trips`\n"
      "\"FROM:TO:CKT:T_OPEN[:T_CLOSE]\", `generator_trips` \"BUS[/ID]:T[:PART]\", `load_steps`\n"
      "\"BUS:P:Q:T_ON[:T_OFF]\" [MW, Mvar], `vref_steps` and `pref_steps` \"BUS[/ID]:T:STEP\" [s, pu].\n"
      "`t_end` [s], `rate` [1/s]; `plants`, `channels`: recorded ones, default all; `buses`: numbers of\n"
      "buses whose voltage is recorded too.");
}

}  // namespace swingbank::python
