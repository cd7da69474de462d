// Converters in the SIMD kernel against the reference integrator, through faults at and near their terminal.
#include <map>

#include "sim/batch/batch.hpp"
#include "sim/grid/far.hpp"
#include "sim/library/library.hpp"
#include "tests/sim/batch/random_grids.hpp"
#include "tests/sim/batch/run_jobs.hpp"

namespace swingbank::sim::batch {
namespace {

constexpr double kConverterLimit =
    2e-4;  ///< relative to max(1 pu, the channel's swing); measured up to 1.1e-4
constexpr std::size_t kConverter = 1;
constexpr int kMiddle = 1, kTerminal = 2;  ///< buses

using Values = std::map<std::string, double>;
struct Outfit {
  std::string name;
  std::vector<std::pair<std::string, Values>> blocks;  ///< the source first
  /// Reactance of the nearest fault that is not bolted [pu]. At smaller reactances a given current has
  /// several voltage solutions, or a solution that vanishes during the fault, and the two integrators may
  /// follow different solutions.
  double nearest = 0.001;
};

plant::Block block_of(const std::string& name, const Values& changes) {
  const Effect& effect = *library::compiled().find(name);
  plant::Block block{&effect, effect.default_parameters()};
  for (const auto& [parameter, value] : changes)
    block.p.at(static_cast<std::size_t>(effect.parameter_index(parameter))) = value;
  return block;
}
grid::Grid grid_with(const Outfit& outfit) {
  grid::Grid grid = test::two_machine_grid(Conventions::psse());
  plant::Plant& plant = grid.plants[kConverter];
  plant.machine = block_of(outfit.blocks[0].first, outfit.blocks[0].second);
  for (std::size_t i = 1; i < outfit.blocks.size(); ++i)
    plant.controls.push_back(block_of(outfit.blocks[i].first, outfit.blocks[i].second));
  std::ranges::stable_sort(plant.controls, {}, [](const plant::Block& b) { return b.effect->slot; });
  grid::look_far(grid);
  return grid;
}

std::map<std::uint64_t, Trajectory> play(const grid::Grid& grid, const std::vector<network::Event>& all) {
  BatchOptions options;
  options.t_end = 4.0;
  options.rate = 60.0;
  return run_events(grid, all, options);
}
reference::ReferenceRun play_exactly(const grid::Grid& grid, const network::Event& event) {
  reference::ReferenceOptions exact;
  exact.t_end = 4.0;
  exact.rate = 60.0;
  return reference::run_reference(grid, event, exact);
}

std::vector<network::Event> events(const grid::Grid& grid, double nearest) {
  std::vector<network::Event> all(7);
  all[0].faults = {{kMiddle, 1.0, 1.1, {0.0, nearest}}};
  all[1].faults = {{kMiddle, 1.0, 1.3, {0.0, 0.05}}};
  all[2].faults = {{kTerminal, 1.0, 1.15, {}}};
  all[3].faults = {{kTerminal, 1.0, 1.15, {0.01, 0.1}}};
  all[4].trips = {{2, 1.0, 1.5}};
  all[5].generator_trips = {{grid.plants[kConverter].generator, 1.0}};
  all[6].faults = {{kMiddle, 1.0, 1.1, {}}};  // the converter's current has no voltage solution there
  return all;
}

class Converters : public testing::TestWithParam<Outfit> {};

TEST_P(Converters, LanesFollowTheReference) {
  const grid::Grid grid = grid_with(GetParam());
  const auto all = events(grid, GetParam().nearest);
  const auto runs = play(grid, all);
  for (std::size_t e = 0; e < all.size(); ++e) {
    const reference::ReferenceRun expected = play_exactly(grid, all[e]);
    EXPECT_EQ(expected.outcome, Outcome::stable) << "event " << e << " in the reference";
    ASSERT_EQ(runs.at(e).outcome, Outcome::stable) << "event " << e << " in the lanes";
    const auto d = test::difference(grid, all[e], runs.at(e), expected);
    RecordProperty("worst_" + std::to_string(e), testing::PrintToString(d.value) + " " + d.where);
    EXPECT_LT(d.value, kConverterLimit) << "event " << e << ": " << d.where;
  }
}
/// Faults with reactances from 0 (bolted) to 0.02 pu: the run stays stable, whichever voltage solution the
/// converter follows, and even if the solution vanishes.
TEST_P(Converters, RideThroughEveryFault) {
  const grid::Grid grid = grid_with(GetParam());
  std::vector<network::Event> all;
  for (const double x : {0.0, 0.0005, 0.001, 0.002, 0.004, 0.007, 0.01, 0.014, 0.02}) {
    all.emplace_back();
    all.back().faults = {{kMiddle, 1.0, 1.1, {0.0, x}}};
  }
  const auto runs = play(grid, all);
  for (std::size_t e = 0; e < all.size(); ++e) {
    EXPECT_EQ(runs.at(e).outcome, Outcome::stable) << "event " << e << " in the lanes";
    EXPECT_EQ(play_exactly(grid, all[e]).outcome, Outcome::stable) << "event " << e << " in the reference";
  }
}
INSTANTIATE_TEST_SUITE_P(
    All, Converters,
    testing::Values(
        Outfit{"Alone", {{"REGCA1", {{"Lvplsw", 1.0}, {"Tfltr", 0.02}}}}},
        Outfit{"Reecb1", {{"REGCA1", {}}, {"REECB1", {{"Kqv", 2.0}}}}},
        Outfit{"Regulated",
               {{"REGCA1", {}},
                {"REECB1", {{"QFLAG", 1.0}, {"Kqi", 0.1}, {"Vdip", 0.85}}},
                {"REPCA1", {{"RefFlag", 1.0}, {"Kp", 2.0}, {"Vfrz", 0.7}, {"Ddn", 20.0}}}}},
        Outfit{"MeasuresElsewhere",
               {{"REGCA1", {}},
                {"REECB1", {{"QFLAG", 1.0}, {"Kqi", 0.1}, {"Vdip", 0.85}}},
                {"REPCA1",
                 {{"RemoteBus", 2.0},
                  {"FromBus", 3.0},
                  {"ToBus", 2.0},
                  {"Circuit", 1.0},
                  {"RefFlag", 1.0},
                  {"VCFlag", 1.0},
                  {"Xc", 0.03},
                  {"Kp", 2.0},
                  {"Vfrz", 0.7},
                  {"Ddn", 20.0}}}}},
        Outfit{"RidesThrough",
               {{"REGCA1", {}},
                {"REECA1", {{"Vdip", 0.85}, {"Vup", 1.2}, {"Kqv", 2.0}, {"Thld", -0.1}, {"Thld2", 0.2}}},
                {"REPCA1", {}}}},
        Outfit{"HoldsAfterwards",
               {{"REGCA1", {}},
                {"REECA1",
                 {{"Vdip", 0.85},
                  {"Vup", 1.2},
                  {"Kqv", 2.0},
                  {"Thld", 0.207},
                  {"Iqfrz", 0.1},
                  {"PQFLAG", 1.0}}}},
               0.02},
        Outfit{"BehindAnImpedance",
               {{"REGCA1", {}},
                {"REECD1",
                 {{"QFLAG", 1.0},
                  {"VFLAG", 0.0},
                  {"Kvp", 1.0},
                  {"Kvi", 20.0},
                  {"Xc", 0.05},
                  {"Kqv", 2.0},
                  {"Vdip", 0.85}}}}},
        Outfit{"KeepsAndBlocks",
               {{"REGCA1", {}},
                {"REECD1",
                 {{"Vdip", 0.85},
                  {"Kqv", 2.0},
                  {"Thld", 0.207},
                  {"Thld2", 0.157},
                  {"Vblkl", 0.3},
                  {"Tblk", 0.053}}}}},
        Outfit{"Compensator", {{"CSVGN1", {{"CBASE", 50.0}}}}},
        Outfit{"Distributed", {{"DERA1", {{"vtripFlag", 1.0}, {"tvl0", 0.053}, {"tvl1", 0.107}}}}, 0.02},
        Outfit{"DistributedAndTakesNoneOff", {{"DERA1", {}}}, 0.02},
        Outfit{"BehindItsReactance", {{"REGCB1", {}}, {"REECB1", {{"Kqv", 2.0}}}}, 0.02},
        Outfit{"BehindItsReactanceAtOnce",
               {{"REGCB1", {{"Te", 0.0}, {"pqFlag", 1.0}, {"rateFlag", 1.0}, {"Tfltr", 0.02}}},
                {"REECB1", {{"Kqv", 2.0}, {"PQFLAG", 1.0}}}},
               0.02},
        Outfit{"ReactiveCurrentTakesAll",
               {{"REGCB1", {{"Imax", 1.0}}}, {"REECB1", {{"Kqv", 10.0}, {"Imax", 1.0}}}},
               0.02},
        Outfit{"WithItsLoop", {{"REGCC1", {}}, {"REECB1", {{"Kqv", 2.0}}}}, 0.02},
        // With Kip = 10 in addition, the terminal's angle differs by 4.4e-4 rad after the first cycle of the
        // bolted fault. At the terminal voltage of 0.086 pu this is 3.8e-5 pu.
        Outfit{
            "WithItsLoopFrozen",
            {{"REGCC1", {{"Vpllfrz", 0.3}, {"rateFlag", 1.0}, {"Tfltr", 0.02}}}, {"REECB1", {{"Kqv", 2.0}}}},
            0.02},
        Outfit{"WithAFastControl",
               {{"REGCC1", {{"Kip", 10.0}, {"Te", 0.002}}}, {"REECB1", {{"Kqv", 2.0}}}},
               0.02},
        Outfit{"WithItsLoopAtOnce",
               {{"REGCC1", {{"Te", 0.0}, {"Imax", 1.0}, {"pqFlag", 1.0}}},
                {"REECB1", {{"Kqv", 10.0}, {"Imax", 1.0}, {"PQFLAG", 1.0}}}},
               0.02},
        Outfit{"Battery", {{"REGCA1", {}}, {"REECC1", {{"Kqv", 2.0}}}}},
        Outfit{"WindTurbine",
               {{"REGCA1", {}},
                {"REECA1", {{"Vdip", 0.85}, {"Kqv", 2.0}}},
                {"REPCA1", {}},
                {"WTTQA1", {}},
                {"WTPTA1", {}},
                {"WTARA1", {}},
                {"WTDTA1", {}}}}),
    [](const auto& outfit) { return outfit.param.name; });

}  // namespace
}  // namespace swingbank::sim::batch
