// Extraction of every unit of every public case that can be simulated. The plant equals the one in the grid,
// its file is read back unchanged, and it finds its operating point. Its response to the simulated voltage of
// the case has the simulated P and Q. The cases are not part of this repository; tests/README.md states where
// they are searched for.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <regex>

#include "sim/grid/grid.hpp"
#include "sim/grid/limits.hpp"
#include "sim/grid/unit.hpp"
#include "tests/sim/reference/psse_folder.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/plant/plant_dyr.hpp"
#include "validate/plant/plant_file.hpp"
#include "validate/playin/play_in.hpp"

namespace swingbank::validate::plant {
namespace {

namespace fs = std::filesystem;

struct Case {
  std::string name, raw, dyr;
  int version = 0;
  std::optional<double> hz = {};
  sim::network::DeviceReplacement devices = sim::network::DeviceReplacement::checked;
  sim::grid::Lacking complete = sim::grid::Lacking::refused;
};
std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

const std::vector<Case> kCases = {
    {"powerfulcases_ieee14", "ieee14.raw", "ieee14_gensal.dyr"},
    {"powerfulcases_ieee14", "ieee14.raw", "ieee14_gentpj1.dyr"},
    {"griddyn_ieee39", "IEEE39.raw", "IEEE39.dyr"},
    {"gridpack_ieee39", "IEEE39bus_multiloads_xfmr4_smallX_slackmvachange_v33_single.raw",
     "IEEE39bus_exdc1_gridpack.dyr"},
    {"psid_fourbus", "FourBusMulti.raw", "FourBus_multigen.dyr"},
    {"steps_ieee39", "IEEE39.raw", "IEEE39.dyr"},
    {"griddyn_wecc179", "powerflowWECC.raw", "dynamicsWECC.dyr", 30, 60.0},
    {.name = "gridpack_wecc240",
     .raw = "240busWECC_2018_PSS_fixedshunt.raw",
     .dyr = "240busWECC_2018_PSS_mod.dyr",
     .hz = 60.0,
     .complete = sim::grid::Lacking::zero},
    {"gridpack_300bus_cmpld", "300bus_v23_no0imp_pslf.raw", "300bus_detail_model_cmpld_combine.dyr", 23, 60.0,
     sim::network::DeviceReplacement::file},
    {"powerfulcases_activsg2000", "ACTIVSg2000.raw", "ACTIVSg2000.dyr"},
    {.name = "gridpack_texas2000",
     .raw = "texas2000_hr_4882_mod_33.raw",
     .dyr = "texas2000_v23_fullsys_noac_wind_mod.dyr",
     .complete = sim::grid::Lacking::zero}};

fs::path cases() { return sim::test::record_folder("../cases"); }

struct Loaded {
  fs::path raw, dyr;
  std::vector<std::string> ignored;  ///< unsupported models, ignored by the names that the messages state
  sim::grid::Grid grid;
};
/// Loads a case as `simulate` does, with the options that the messages name.
Loaded load(const Case& c) {
  Loaded l{cases() / c.name / c.raw, cases() / c.name / c.dyr, {}, {}};
  sim::grid::CaseOptions options;
  options.raw = {c.hz, c.version};
  options.raw.devices = c.devices;
  options.complete_records = c.complete;
  options.net_generators = true;
  const auto read = [&] { l.grid = sim::grid::load_grid(l.raw, l.dyr, sim::Conventions::psse(), options); };
  const std::regex option("--ignore-model ([A-Z0-9_]+)");
  for (const auto& message : test::messages(read))
    if (std::smatch found; std::regex_search(message, found, option)) l.ignored.push_back(found[1]);
  if (l.ignored.empty()) return l;
  options.dyr.ignore = l.ignored;
  read();
  return l;
}

PlantModel taken_out(const Loaded& l, const Case& c, const sim::plant::Plant& plant) {
  const auto& g = l.grid.network.generators[static_cast<std::size_t>(plant.generator)];
  sim::grid::UnitChoice choice{.raw = l.raw, .dyr = l.dyr};
  choice.bus = l.grid.network.buses[static_cast<std::size_t>(g.bus)].number;
  choice.id = g.id;
  choice.frequency_hz = c.hz;
  choice.raw_version = c.version;
  choice.models.ignore = l.ignored;
  choice.complete_records = c.complete;
  const PlantModel model = model_of_unit(sim::grid::read_unit(choice), sim::Conventions::psse(), c.name);
  return parse_plant_model(plant_text(model, {}), "plant.toml");
}

/// Returns the first difference of an extracted plant from the one in the grid; empty if there is none.
std::string difference_from(const sim::plant::Plant& running, const sim::plant::Plant& taken) {
  if (running.machine.effect != taken.machine.effect || running.machine.p != taken.machine.p)
    return "machine";
  if (running.transformer.effect != taken.transformer.effect || running.transformer.p != taken.transformer.p)
    return "transformer";
  if (running.controls.size() != taken.controls.size()) return "number of controls";
  for (std::size_t k = 0; k < running.controls.size(); ++k)
    if (running.controls[k].effect != taken.controls[k].effect ||
        running.controls[k].p != taken.controls[k].p)
      return std::string(running.controls[k].effect->name);
  return running.mva == taken.mva ? "" : "base";
}

/// Returns the first error of the plant's exported records; empty if the records have the plant's values,
/// with no more digits than manual input has.
std::string fault_of_export(const PlantModel& model) {
  Problems problems;
  const std::string text = dyr_text(model, {}, "plant.toml", problems);
  if (!problems.empty()) return problems.list()[0].sentence();
  const auto records = sim::formats::parse_dyr(text, "plant.dyr");
  std::vector<const sim::plant::Block*> blocks = {&model.plant.machine};
  for (const auto& control : model.plant.controls) blocks.push_back(&control);
  if (records.size() != blocks.size()) return "number of records";
  for (std::size_t k = 0; k < blocks.size(); ++k)
    for (std::size_t i = 0; i < records[k].values.size(); ++i)
      if (records[k].values[i] != blocks[k]->p[static_cast<std::size_t>(blocks[k]->effect->dyr_columns[i])])
        return records[k].model + " as exported";
  const std::regex tail("[0-9]{13}");
  return std::regex_search(text, tail) ? "a number with a tail in " + text : "";
}

class EveryUnitFull : public ::testing::TestWithParam<Case> {};

TEST_P(EveryUnitFull, IsExtractedAndInitialised) {
  Loaded l = load(GetParam());
  const auto before = l.grid.plants;
  sim::grid::settle_limits(l.grid, true);
  int taken = 0, widened = 0, unusual = 0;
  std::string failed;
  for (std::size_t k = 0; k < before.size(); ++k) {
    std::string why;
    const auto messages = test::messages([&] {
      PlantModel model = taken_out(l, GetParam(), before[k]);
      why = difference_from(before[k], model.plant);
      if (why.empty()) why = fault_of_export(model);
      unusual += std::ranges::any_of(
          model.warnings, [](const std::string& w) { return w.find("usual range of") != std::string::npos; });
      widened += difference_from(before[k], l.grid.plants[k]).empty() ? 0 : 1;
      model.plant.controls = l.grid.plants[k].controls;  // with widened limits
      model.plant.generation = before[k].generation;
      (void)sim::plant::operating_point(model.plant,
                                        l.grid.flow.voltage[static_cast<std::size_t>(before[k].bus)],
                                        l.grid.network.base_mva, model.conventions);
    });
    if (!messages.empty()) why = messages[0];
    taken += why.empty() ? 1 : 0;
    if (!why.empty()) failed += "\n" + before[k].name + ": " + why;
  }
  std::printf(
      "%s %s: %d of %zu units, %d with unusual values, %d with a limit moved to the case's dispatch\n",
      GetParam().name.c_str(), GetParam().dyr.c_str(), taken, before.size(), unusual, widened);
  EXPECT_GT(before.size(), 0u);
  EXPECT_EQ(failed, "");
}
INSTANTIATE_TEST_SUITE_P(Cases, EveryUnitFull, ::testing::ValuesIn(kCases),
                         [](const auto& i) { return std::to_string(i.index) + "_" + i.param.name; });

/// A case with a fault at one bus, and the units with recorded terminals.
struct Replay {
  std::size_t which;  ///< index into kCases
  int fault;
  std::vector<std::string> units;
};
std::ostream& operator<<(std::ostream& out, const Replay& r) { return out << kCases[r.which].name; }
class ReplayFull : public ::testing::TestWithParam<Replay> {};

TEST_P(ReplayFull, ExtractedUnitReproducesTheSimulation) {
  const Case& c = kCases[GetParam().which];
  Loaded l = load(c);
  const auto before = l.grid.plants;
  sim::grid::settle_limits(l.grid, true);
  test::Simulated s{l.grid, 1.0, 1.1, {}, {}};
  sim::network::Event event;
  event.faults.push_back({s.grid.network.bus_index(GetParam().fault), s.t_on, s.t_off, {}});
  sim::reference::ReferenceOptions options;
  options.rate = 480.0;
  options.t_end = 4.0;
  options.rtol = 1e-9;
  options.atol = 1e-11;
  options.channels = {sim::Channel::V, sim::Channel::theta, sim::Channel::P, sim::Channel::Q};
  for (std::size_t k = 0; k < before.size(); ++k)
    if (std::ranges::count(GetParam().units, before[k].name) > 0)
      options.plants.push_back(static_cast<int>(k));
  ASSERT_EQ(options.plants.size(), GetParam().units.size());
  s.before = sim::reference::run_reference(s.grid, event, options);
  options.after_switching = true;
  s.after = sim::reference::run_reference(s.grid, event, options);
  for (int row = 0; row < static_cast<int>(options.plants.size()); ++row) {
    const auto k = static_cast<std::size_t>(options.plants[static_cast<std::size_t>(row)]);
    PlantModel model = taken_out(l, c, before[k]);
    model.plant.controls = l.grid.plants[k].controls;
    record::Record r = test::record_of(s, row, 1);
    r.base.mva = before[k].mva;
    const auto back =
        playin::play_in(model.under_test(), r, playin::VoltageCurve(r, test::exact_switchings(s, row, true)));
    double worst = 0.0;
    for (std::size_t i = 0; i < r.t.size(); ++i)
      worst = std::max({worst, std::abs(back.P[i] - r.P[i]), std::abs(back.Q[i] - r.Q[i])});
    std::printf("%s unit %s: %.1e pu\n", c.name.c_str(), before[k].name.c_str(), worst);
    EXPECT_LT(worst, 1e-5) << before[k].name;
  }
}
INSTANTIATE_TEST_SUITE_P(Cases, ReplayFull,
                         ::testing::Values(Replay{2, 16, {"31", "38"}}, Replay{3, 16, {"32", "36"}},
                                           Replay{6, 68, {"70", "36"}}, Replay{5, 16, {"32", "34"}}));

}  // namespace
}  // namespace swingbank::validate::plant
