// DEGOV and DEGOV1: transfer functions, the delay, droop, throttle's limits.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
const ControlBench::Changes kDiesel = {{"T1", 0.3}, {"T2", 0.2}, {"T3", 0.5},  {"K", 8.0},
                                       {"T4", 0.6}, {"T5", 0.1}, {"T6", 0.05}, {"TD", 0.04}};
C engine(double omega, double delay) {
  const C s(0.0, omega);
  return (1.0 + 0.5 * s) / (1.0 + 0.3 * s + 0.06 * s * s) * 8.0 / s * lead_over_lag(0.6, 0.1, omega) *
         lead_over_lag(0.0, 0.05, omega) * std::exp(-delay * s);
}

TEST(GovernorDiesel, IsochronousGovernorIntegratesTheSpeed) {
  for (const double omega : {0.3, 1.0, 7.0, 30.0}) {
    ControlBench bench("DEGOV", kDiesel);
    ASSERT_TRUE(bench.problems.empty());
    EXPECT_LT(bench.largest_derivative(), 1e-12);
    // the power is the engine's torque times (1 + w): the speed deviation also acts directly, with the factor
    // 0.8
    const C exact = 0.8 - engine(omega, 0.04);
    const C h = bench.response(&Signals<double>::speed, &Signals<double>::Tm, omega);
    EXPECT_LT(std::abs(h - exact), 1e-4 * std::abs(exact))
        << omega;  // error of the delay's rational approximation at s TD = 1.2j: 2e-6
  }
}

TEST(GovernorDiesel, EqualsTheActuator_WithoutDelayAndControlBox) {
  auto values = kDiesel;
  values["TD"] = values["T1"] = values["T2"] = values["T3"] = 0.0;
  for (const double omega : {0.3, 7.0}) {
    ControlBench bench("DEGOV", values);
    ASSERT_TRUE(bench.problems.empty());
    const C s(0.0, omega);
    const C exact = 0.8 - 8.0 / s * lead_over_lag(0.6, 0.1, omega) * lead_over_lag(0.0, 0.05, omega);
    EXPECT_LT(std::abs(bench.response(&Signals<double>::speed, &Signals<double>::Tm, omega) - exact), 1e-6);
  }
}

TEST(GovernorDiesel, DelayShiftsAStep) {
  ControlBench bench("DEGOV", {{"TD", 1.0},
                               {"K", 1.0},
                               {"T1", 0.0},
                               {"T2", 0.0},
                               {"T3", 0.0},
                               {"T5", 0.0},
                               {"T6", 0.0},
                               {"TMAX", 2.0}});
  bench.in.dPref = 0.05;  // the throttle rises by 0.05 pu/s
  bench.run(5.0);
  EXPECT_NEAR(bench.out().Tm, 0.8 + 0.05 * 4.0, 1e-6);
}

TEST(GovernorDiesel, DroopIsOfThrottleOrPower) {
  for (const double code : {0.0, 1.0}) {
    ControlBench bench("DEGOV1", {{"M", code}, {"DROOP", 0.04}, {"K", 8.0}});
    ASSERT_TRUE(bench.problems.empty());
    EXPECT_LT(bench.largest_derivative(), 1e-12);
    bench.in.speed = -0.002;
    if (code == 1.0) bench.in.P += 0.05;
    bench.run(60.0);
    if (code == 0.0)
      EXPECT_NEAR(bench.state("throttle"), 0.8 + 0.002 / 0.04, 1e-6);
    else
      // The power has reached the droop's value, except for the integral over the lag of its transducer.
      EXPECT_NEAR(bench.state("throttle"), 0.8 + 8.0 * 0.002 * 0.1, 1e-6);
  }
}

TEST(GovernorDiesel, ThrottleDoesNotWindUp) {
  ControlBench bench("DEGOV", {{"TMAX", 0.9}});
  bench.in.speed = -0.05;
  bench.run(10.0);
  EXPECT_EQ(bench.state("integral"), 0.9);
  EXPECT_NEAR(bench.out().Tm, 0.9 * 0.95, 1e-9);
  bench.in.speed = 0.05;
  bench.run(0.1);
  EXPECT_LT(bench.state("throttle"), 0.9);
}

TEST(GovernorDiesel, RefusesParametersThatCannotBeIntegrated) {
  using Change = std::pair<const char*, double>;
  for (const auto& [name, value] : {Change{"K", 0.0}, {"TD", -1.0}, {"T1", 0.0}, {"TMIN", 2.0}})
    EXPECT_FALSE(ControlBench("DEGOV", {{name, value}}).problems.empty()) << name;
  EXPECT_FALSE(ControlBench("DEGOV1", {{"M", 2.0}}).problems.empty());
  EXPECT_EQ(ControlBench("DEGOV", {{"TMAX", 0.7}}).refused, "integral outside its limits");
}

}  // namespace
}  // namespace swingbank::sim::test
