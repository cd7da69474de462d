// IEEEG1: transfer function, droop, speed and position limits of the valve without wind-up, dead-band.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

const ControlBench::Changes kIeeeg1Values = {{"K", 20.0}, {"T1", 0.2},  {"T2", 0.05},  {"T3", 0.2},
                                             {"UO", 0.2}, {"UC", -0.3}, {"PMAX", 1.0}, {"PMIN", 0.0},
                                             {"T4", 0.3}, {"K1", 0.3},  {"T5", 7.0},   {"K3", 0.4},
                                             {"T6", 0.5}, {"K5", 0.2},  {"T7", 0.4},   {"K7", 0.1}};

TEST(GovernorIeeeg1, SmallSignalsFollowTheTransferFunction) {
  ControlBench bench("IEEEG1", kIeeeg1Values);
  EXPECT_TRUE(bench.problems.empty());
  EXPECT_LT(bench.largest_derivative(), 1e-14);
  for (const double omega : {0.01, 0.1, 1.0, 10.0}) {
    const auto lag = [&](double T) { return lead_over_lag(0.0, T, omega); };
    const auto valve = -20.0 * lead_over_lag(0.05, 0.2, omega) * lag(0.2);  // the servo closes over T3
    const auto x4 = lag(0.3), x5 = x4 * lag(7.0), x6 = x5 * lag(0.5), x7 = x6 * lag(0.4);
    const auto exact = valve * (0.3 * x4 + 0.4 * x5 + 0.2 * x6 + 0.1 * x7);
    const auto h = bench.response(&Signals<double>::speed, &Signals<double>::Tm, omega);
    EXPECT_LT(std::abs(h - exact), 1e-7 * (1.0 + std::abs(exact))) << omega;  // difference step: 1e-6
  }
}

TEST(GovernorIeeeg1, SharesNeedNotAddUpToOne) {
  auto values = kIeeeg1Values;
  values["K1"] = 0.8;  // sum 1.5
  ControlBench bench("IEEEG1", values);
  EXPECT_NEAR(bench.state("valve"), 0.8 / 1.5, 1e-14);
  EXPECT_NEAR(bench.out().Tm, 0.8, 1e-14);
}

TEST(GovernorIeeeg1, DroopBeyondTheDeadBand) {
  auto values = kIeeeg1Values;
  values["db"] = 0.0006;
  ControlBench bench("IEEEG1", values);
  bench.in.speed = -0.0006;
  EXPECT_LT(bench.largest_derivative(), 1e-14);
  bench.in.speed = -0.0026;
  bench.run(200.0, 5e-3);
  EXPECT_NEAR(bench.out().Tm, 0.8 + 20.0 * 0.002, 1e-10);  // remainder: 0.04 exp(-200/7) = 2e-14
}

TEST(GovernorIeeeg1, ValveRespectsRateLimitsAndLeavesItsEndWithoutDelay) {
  ControlBench bench("IEEEG1", kIeeeg1Values);
  bench.in.speed = -0.05;
  bench.run(0.5);
  EXPECT_NEAR(bench.state("valve"), 0.8 + 0.2 * 0.5, 1e-12);  // the error, 0.25 pu, exceeds UO T3 immediately
  bench.run(10.0);
  EXPECT_EQ(bench.state("valve"), 1.0);
  bench.in.speed = 0.05;
  bench.run(2.0);
  const double before = bench.state("valve");
  EXPECT_LT(before, 1.0 - 0.3 * 1.8);  // only T1 = 0.2 s passes before it closes: no wind-up
  bench.run(1.0);
  EXPECT_NEAR(bench.state("valve"), std::max(0.0, before - 0.3), 1e-12);
}

TEST(GovernorIeeeg1, RefusesParametersThatCannotBeIntegrated) {
  using Change = std::pair<const char*, double>;
  for (const auto& [name, value] :
       {Change{"T3", 0.0}, {"UC", 0.1}, {"K2", 0.2}, {"JBUS", 7.0}, {"PMIN", 2.0}, {"db", -0.1}})
    EXPECT_FALSE(ControlBench("IEEEG1", {{name, value}}).problems.empty()) << name;
  EXPECT_FALSE(ControlBench("IEEEG1", {{"K1", 0.0}, {"K3", 0.0}, {"K5", 0.0}, {"K7", 0.0}}).problems.empty());
  EXPECT_EQ(ControlBench("IEEEG1", {{"PMAX", 0.7}}).refused, "valve outside its limits");
}

}  // namespace
}  // namespace swingbank::sim::test
