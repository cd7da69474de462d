// Switched shunts that step in the power flow: into the band, at a remote bus, to the last step, oscillating.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/network/powerflow.hpp"

namespace swingbank::sim::network {
namespace {

/// Slack bus A, bus B with a load of 0.5 + j0.4 pu behind 0.2 pu, and bus C behind another 0.1 pu.
Network two_lines() {
  Network n;
  n.origin = "two lines";
  n.buses = {{1, "A", 110.0, BusType::slack, 1.0, 0.0},
             {2, "B", 110.0, BusType::load, 1.0, 0.0},
             {3, "C", 110.0, BusType::load, 1.0, 0.0}};
  n.loads = {{1, "1", {0.5, 0.4}, {}, {}}};
  n.branches = {{0, 1, "1", 0.0, 0.2, 0.0}, {1, 2, "1", 0.0, 0.1, 0.0}};
  Generator g{};
  g.id = "1";
  g.vset = 1.0;
  g.mva = 100.0;
  g.in_service = true;
  n.generators = {g};
  return n;
}
SwitchedShunt bank(double least, double most) {
  return {1, "SW", 0.0, 1, least, most, {-0.2, -0.1, 0.0, 0.1, 0.2, 0.3, 0.4, 0.5}};
}
PowerFlow stepped(const Network& n) {
  PowerFlowOptions options;
  options.step_shunts = true;
  return solve_power_flow(n, options);
}

TEST(ShuntSteps, StayFixedUnlessRequested) {
  Network n = two_lines();
  n.switched = {bank(0.99, 1.01)};
  const PowerFlow flow = solve_power_flow(n);
  EXPECT_TRUE(flow.stepped.empty());
  EXPECT_LT(std::abs(flow.voltage[1]), 0.93);
}

TEST(ShuntSteps, TakeTheFirstStepInTheBand) {
  Network n = two_lines();
  n.switched = {bank(0.96, 1.04)};
  const PowerFlow flow = stepped(n);
  ASSERT_EQ(flow.stepped.size(), 1u);
  const double b = flow.stepped[0].susceptance;
  EXPECT_TRUE(flow.stepped[0].in_band);
  EXPECT_GE(std::abs(flow.voltage[1]), 0.96);
  // One step less would not suffice, and the solution equals that with a fixed shunt.
  for (const double fixed : {b - 0.1, b}) {
    Network with = two_lines();
    with.shunts = {{1, "1", {0.0, fixed}}};
    const PowerFlow alone = solve_power_flow(with);
    if (fixed == b)
      EXPECT_NEAR(std::abs(alone.voltage[1] - flow.voltage[1]), 0.0, 1e-12);
    else
      EXPECT_LT(std::abs(alone.voltage[1]), 0.96);
  }
}

TEST(ShuntSteps, RegulateARemoteBusAndSwitchReactorsIn) {
  Network n = two_lines();
  n.shunts = {{2, "1", {0.0, 1.0}}};  // high voltage at bus 3
  SwitchedShunt s = bank(0.9, 1.05);
  s.bus = 2;
  n.switched = {s};
  EXPECT_GT(std::abs(solve_power_flow(n).voltage[2]), 1.08);
  n.switched[0].steps = {-0.8, -0.6, -0.4, -0.2, 0.0};
  n.switched[0].regulated = 1;
  const PowerFlow flow = stepped(n);
  ASSERT_EQ(flow.stepped.size(), 1u);
  EXPECT_LT(flow.stepped[0].susceptance, 0.0);
  EXPECT_TRUE(flow.stepped[0].in_band);
  EXPECT_LE(std::abs(flow.voltage[1]), 1.05);
}

TEST(ShuntSteps, StopAtTheLastStepAndReportIt) {
  Network n = two_lines();
  n.switched = {bank(1.2, 1.3)};
  const PowerFlow flow = stepped(n);
  ASSERT_EQ(flow.stepped.size(), 1u);
  EXPECT_EQ(flow.stepped[0].susceptance, 0.5);
  EXPECT_FALSE(flow.stepped[0].in_band);
}

TEST(ShuntSteps, StopWhenTheBandIsNarrowerThanAStep) {
  Network n = two_lines();
  n.switched = {bank(0.9701, 0.9702)};
  const PowerFlow flow = stepped(n);
  ASSERT_EQ(flow.stepped.size(), 1u);
  EXPECT_FALSE(flow.stepped[0].in_band);
  EXPECT_NEAR(std::abs(flow.voltage[1]), 0.97, 0.025);  // the step next to the band
}

}  // namespace
}  // namespace swingbank::sim::network
