// GAST: transfer function below the temperature limit, steady state at that limit, limits without wind-up.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

const ControlBench::Changes kGastValues = {{"R", 0.05},   {"T1", 0.4},     {"T2", 0.1},
                                           {"T3", 3.0},   {"AT", 0.9},     {"KT", 2.0},
                                           {"VMAX", 1.1}, {"VMIN", -0.05}, {"Dturb", 0.3}};

TEST(GovernorGast, SmallSignalsFollowTheTransferFunction) {
  ControlBench bench("GAST", kGastValues);
  EXPECT_LT(bench.largest_derivative(), 1e-14);
  for (const double omega : {0.01, 0.1, 1.0, 10.0}) {
    const auto exact = -20.0 * lead_over_lag(0.0, 0.4, omega) * lead_over_lag(0.0, 0.1, omega) - 0.3;
    const auto h = bench.response(&Signals<double>::speed, &Signals<double>::Tm, omega);
    EXPECT_LT(std::abs(h - exact), 1e-7 * (1.0 + std::abs(exact))) << omega;  // difference step: 1e-6
  }
}

TEST(GovernorGast, TemperatureLimitsThePowerAndReleases) {
  ControlBench bench("GAST", kGastValues);
  bench.in.speed = -0.02;  // demand of the droop: 1.2 pu
  bench.run(0.3);
  EXPECT_GT(bench.state("fuel"), 0.9);  // the measurement is slow: the fuel exceeds the limit temporarily
  bench.run(60.0);
  // fuel = AT + KT (AT - fuel) has the only solution AT; the slowest mode has T3/(1 + KT) = 1 s.
  EXPECT_NEAR(bench.out().Tm, 0.9 + 0.3 * 0.02, 1e-12);
  bench.in.speed = 0.0;
  bench.run(60.0);
  EXPECT_NEAR(bench.out().Tm, 0.8, 1e-8);  // remainder: 0.1 exp(-60/3)
}

TEST(GovernorGast, FuelValveStopsAtItsLimitsWithoutWindUp) {
  ControlBench bench("GAST", kGastValues);
  bench.in.speed = 0.1;  // demand of the droop: -1.2 pu
  bench.run(10.0);
  EXPECT_EQ(bench.state("fuel"), -0.05);
  bench.in.speed = 0.0;
  bench.run(0.4);
  EXPECT_NEAR(bench.state("fuel"), 0.8 - 0.85 * std::exp(-1.0), 1e-9);  // T1 from the limit, without delay
}

TEST(GovernorGast, DeadBandSubtractsItsWidthFromTheSpeed) {
  auto values = kGastValues;
  values["db"] = 0.0006;
  ControlBench bench("GAST", values);
  bench.in.speed = 0.0005;
  EXPECT_LT(bench.largest_derivative(), 1e-14);
  bench.in.speed = 0.0016;
  EXPECT_NEAR(bench.derivative()[0], -0.001 / 0.05 / 0.4, 1e-12);
}

TEST(GovernorGast, ToleratesRoundingAtTheTemperatureLimit) {
  auto at = ControlBench::rated();
  at.Tm = 0.9 + 1e-12;
  ControlBench bench("GAST", kGastValues, at);
  EXPECT_EQ(bench.refused, "");
  EXPECT_LT(bench.largest_derivative(), 1e-14);
}

TEST(GovernorGast, RefusesParametersThatCannotBeIntegrated) {
  EXPECT_NE(ControlBench("GAST", {{"AT", 0.7}}).refused.find("AT = 0.7 pu"), std::string::npos);
  EXPECT_EQ(ControlBench("GAST", {{"VMAX", 0.7}}).refused, "fuel outside its limits");
  using Change = std::pair<const char*, double>;
  for (const auto& [name, value] : {Change{"R", 0.0}, {"T1", 0.0}, {"KT", -1.0}, {"VMIN", 2.0}, {"T3", -1.0}})
    EXPECT_FALSE(ControlBench("GAST", {{name, value}}).problems.empty()) << name;
}

}  // namespace
}  // namespace swingbank::sim::test
