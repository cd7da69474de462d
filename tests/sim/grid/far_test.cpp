// Remote measurements of a plant's control: the voltage of a bus, the flow of a branch.
#include "sim/grid/far.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <string>

#include "sim/grid/operating_point.hpp"
#include "sim/grid/unit.hpp"
#include "sim/reference/reference.hpp"
#include "tests/sim/grid/far_case.hpp"
#include "tests/sim/network/branch_index.hpp"

namespace swingbank::sim::grid::far_control {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

network::Event more_load(const Grid& grid) {
  network::Event event;
  event.load_steps.push_back({grid.network.bus_index(103), {0.3, 0.15}, 1.0, {}});
  return event;
}
reference::ReferenceRun run(const Grid& grid, const network::Event& event, int bus, double t_end = 10.0) {
  reference::ReferenceOptions options;
  options.t_end = t_end;
  options.rate = 30.0;
  options.rtol = 1e-9;
  options.buses = {grid.network.bus_index(bus)};
  return run_reference(grid, event, options);
}
double apart(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double most = 0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}

TEST(FarControl, NetworkTransformerEqualsThatOfTheGeneratorRecord) {
  const Grid one = load_from(behind_a_branch(), plants({}));
  const Complex V = one.flow.voltage[1];
  Control other;
  other.bus = "102";
  const Grid two = load_from(behind_its_own_transformer(80.0, std::abs(V)), plants(other));
  const auto a = run(one, more_load(one), 102), b = run(two, more_load(two), 102);
  ASSERT_EQ(a.outcome, Outcome::stable);
  EXPECT_LT(apart(a.bus_v, b.bus_v), 1e-7);
  Control terminal;
  terminal.codes = "0 0 0 '0'";
  const Grid near = load_from(behind_a_branch(), plants(terminal));
  EXPECT_GT(apart(a.bus_v, run(near, more_load(near), 102).bus_v), 1e-3);
}

TEST(FarControl, RegulatesTheVoltageOfTheRemoteBus) {
  Control control;
  control.droop = "0 0 0";
  const Grid grid = load_from(behind_a_branch(), plants(control));
  const auto moved = run(grid, more_load(grid), 102, 40.0);
  EXPECT_NEAR(moved.bus_v.back(), std::abs(grid.flow.voltage[1]), 1e-5);
  const auto own = run(grid, more_load(grid), 104, 40.0);
  EXPECT_GT(std::abs(own.bus_v.back() - std::abs(grid.flow.voltage[3])), 1e-3);
}

TEST(FarControl, IsSteadyWithoutAnEvent) {
  const Grid grid = load_from(behind_a_branch(), plants({}));
  const auto still = run(grid, {}, 102);
  for (const double v : still.bus_v) EXPECT_NEAR(v, std::abs(grid.flow.voltage[1]), 1e-9);
}

TEST(FarControl, MeasuresTheFlowAtTheFirstBusOfItsBranch) {
  const Grid out = load_from(behind_a_branch(), plants({}));
  Control reversed;
  reversed.codes = "102 103 102 '1'";
  const Grid in = load_from(behind_a_branch(), plants(reversed));
  const Far<double> there = out.plants.at(1).far.value(), back = in.plants.at(1).far.value();
  EXPECT_NEAR(there.P, 0.8, 1e-9);
  const double losses = 0.01 * (there.Ir * there.Ir + there.Ii * there.Ii);
  EXPECT_NEAR(back.P, -0.8 + losses, 1e-9);
  EXPECT_NEAR(std::hypot(there.Vr, there.Vi), std::abs(out.flow.voltage[1]), 1e-12);
}

TEST(FarControl, OpenBranchHasZeroFlow) {
  Control control;
  control.flags = "0 0 1";  // Q of the branch, P of the branch
  formats::RawCase doubled = behind_a_branch();
  doubled.branches += "102,103,'2',0.01,0.12,0.0,250,250,250,0,0,0,0,1,1,0,1,1\n";
  const Grid two = load_from(doubled, plants(control));
  EXPECT_NEAR(two.plants.at(1).far.value().P, 0.4, 1e-9);
  network::Event event;
  event.trips.push_back({network::branch_index(two.network, 102, 103, "1"), 1.0, {}});
  // The control restores the branch flow until the plant is at its limit.
  reference::ReferenceOptions options;
  options.t_end = 20.0;
  options.rate = 30.0;
  options.plants = {1};
  options.channels = {Channel::P};
  const auto run = run_reference(two, event, options);
  ASSERT_EQ(run.outcome, Outcome::stable);
  const double* P = run.at(0, 0);
  EXPECT_NEAR(P[0], 0.8, 1e-6);
  EXPECT_GT(P[run.samples - 1], 1.05);
}

TEST(FarControl, ReportsUnknownBusesAndBranches) {
  Control control;
  control.codes = "999 102 101 '1'";
  const Grid grid = load_from(behind_a_branch(), plants(control));
  std::string said;
  for (const network::Remark& remark : grid.network.remarks) said += remark_line(remark, 5) + "\n";
  EXPECT_THAT(said, HasSubstr("REPCA1 of generator 104: bus 999"));
  EXPECT_THAT(said, HasSubstr("REPCA1 of generator 104: branch 102 - 101, circuit 1"));
  EXPECT_FALSE(grid.plants.at(1).far.has_value());
}

TEST(FarControl, IsolatedBusIsNotMeasured) {
  Control control;
  control.codes = "105 0 0 '0'";
  formats::RawCase raw = behind_a_branch();
  raw.buses += "105,'GONE',138.0,4,1,1,1,1.0,0.0,1.1,0.9,1.1,0.9\n";
  const Grid grid = load_from(raw, plants(control));
  std::string said;
  for (const network::Remark& remark : grid.network.remarks) said += remark_line(remark, 5) + "\n";
  EXPECT_THAT(said, HasSubstr("REPCA1 of generator 104: bus 105"));
  EXPECT_FALSE(grid.plants.at(1).far.has_value());
}

TEST(FarControl, IsRecomputedAtAnotherOperatingPoint) {
  const Grid grid = load_from(behind_a_branch(), plants({}));
  network::Network less = grid.network;
  less.generators.at(1).p *= 0.5;
  const Grid at = at_operating_point(grid, less);
  EXPECT_NEAR(at.plants.at(1).far.value().P, 0.4, 1e-9);
  Grid larger = grid;
  set_machine_base(larger, 1, 200.0);
  EXPECT_NEAR(larger.plants.at(1).far.value().P, 0.4, 1e-9);
}

TEST(FarControl, ExtractedUnitReportsItsMeasuringBus) {
  const formats::ScratchFile r("case.raw", behind_a_branch().text()), d("case.dyr", plants({}));
  UnitChoice choice;
  choice.raw = r.path;
  choice.dyr = d.path;
  choice.bus = 104;
  EXPECT_THAT(read_unit(choice).notes, Contains(HasSubstr("REPCA1 measures at bus 102")));
}

}  // namespace
}  // namespace swingbank::sim::grid::far_control
