// TGOV1: step of the reference in closed form, droop, dead-band, valve limits without wind-up, bypasses.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

const ControlBench::Changes kTgov1Values = {{"R", 0.05}, {"T1", 0.2}, {"VMAX", 1.2}, {"VMIN", 0.1},
                                            {"T2", 0.3}, {"T3", 0.8}, {"Dt", 0.0}};

TEST(GovernorTgov1, StepOfTheReferenceFollowsTheClosedForm) {
  ControlBench bench("TGOV1", kTgov1Values);
  EXPECT_LT(bench.largest_derivative(), 1e-14);
  bench.in.dPref = 0.1;
  for (double t = 0.25; t < 6.0; t += 0.25) {
    bench.run(0.25);
    // Partial fractions of (1 + 0.3 s)/(s (1 + 0.2 s)(1 + 0.8 s)).
    const double exact = 0.8 + 0.1 * (1.0 - (0.8 - 0.3) / (0.8 - 0.2) * std::exp(-t / 0.8) -
                                      (0.2 - 0.3) / (0.2 - 0.8) * std::exp(-t / 0.2));
    EXPECT_NEAR(bench.out().Tm, exact, 1e-11) << t;  // (1 ms / 0.2 s)^4 / 120 of 0.1 pu
  }
}

TEST(GovernorTgov1, DroopAndTurbineDamping) {
  auto values = kTgov1Values;
  values["Dt"] = 0.5;
  ControlBench bench("TGOV1", values);
  bench.in.speed = -0.005;
  bench.run(30.0);
  EXPECT_NEAR(bench.out().Tm, 0.8 + 0.005 / 0.05 + 0.5 * 0.005, 1e-12);  // exp(-30 / 0.8) is smaller
}

TEST(GovernorTgov1, DeadBandSubtractsItsWidthFromTheSpeed) {
  auto values = kTgov1Values;
  values["db"] = 0.0006;
  ControlBench bench("TGOV1", values);
  bench.in.speed = 0.0005;
  EXPECT_EQ(bench.largest_derivative(), 0.0);
  bench.in.speed = -0.0016;
  bench.run(30.0);
  EXPECT_NEAR(bench.out().Tm, 0.8 + 0.001 / 0.05, 1e-12);  // exp(-30 / 0.8) is smaller
}

TEST(GovernorTgov1, ValveStopsAtItsLimitsAndLeavesThemWithoutDelay) {
  auto values = kTgov1Values;
  values["T2"] = values["T3"] = 0.0;  // no reheater: the power equals the valve position
  ControlBench bench("TGOV1", values);
  bench.in.speed = -0.1;
  bench.run(10.0);
  EXPECT_EQ(bench.out().Tm, 1.2);
  bench.in.speed = 0.0;
  bench.run(0.1);
  EXPECT_NEAR(bench.out().Tm, 0.8 + 0.4 * std::exp(-0.1 / 0.2), 1e-11);  // independent of the 10 s before
  bench.in.speed = 0.1;
  bench.run(10.0);
  EXPECT_EQ(bench.out().Tm, 0.1);
  bench.in.speed = 0.0;
  bench.run(0.1);
  EXPECT_NEAR(bench.out().Tm, 0.8 - 0.7 * std::exp(-0.1 / 0.2), 1e-11);
}

TEST(GovernorTgov1, ZeroTimeConstantIsABypassAndKeepsTheLimits) {
  ControlBench bench("TGOV1", {{"T1", 0.0}, {"T3", 0.0}, {"VMAX", 0.9}});
  bench.in.dPref = 0.05;
  EXPECT_NEAR(bench.out().Tm, 0.85, 1e-15);
  bench.in.dPref = 0.5;
  EXPECT_EQ(bench.out().Tm, 0.9);
}

TEST(GovernorTgov1, OperatingPointAboveTheValveIsRefused) {
  EXPECT_EQ(ControlBench("TGOV1", {{"VMAX", 0.7}}).refused, "valve outside its limits");
  EXPECT_FALSE(ControlBench("TGOV1", {{"R", 0.0}}).problems.empty());
}

}  // namespace
}  // namespace swingbank::sim::test
