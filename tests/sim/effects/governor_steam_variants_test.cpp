// TGOV3 and IEESGO: transfer functions against their diagrams, limits, droop.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;

TEST(GovernorSteamVariants, Tgov3SmallSignals) {
  const ControlBench::Changes values = {{"K", 20.0}, {"T1", 0.2}, {"T2", 0.05}, {"T3", 0.2}, {"T4", 0.3},
                                        {"K1", 0.3}, {"T5", 7.0}, {"K2", 0.4},  {"T6", 0.5}, {"K3", 0.3}};
  for (const double omega : {0.01, 0.1, 1.0, 10.0}) {
    ControlBench bench("TGOV3", values);
    ASSERT_TRUE(bench.problems.empty());
    const auto lag = [&](double T) { return lead_over_lag(0.0, T, omega); };
    const C valve = -20.0 * lead_over_lag(0.05, 0.2, omega) * lag(0.2), x4 = lag(0.3), x5 = x4 * lag(7.0);
    const C exact = valve * (0.3 * x4 + 0.4 * x5 + 0.3 * x5 * lag(0.5));
    const C h = bench.response(&Signals<double>::speed, &Signals<double>::Tm, omega);
    EXPECT_LT(std::abs(h - exact), 1e-7 * (1.0 + std::abs(exact))) << omega;
  }
}

TEST(GovernorSteamVariants, Tgov3ReheaterIsLimitedByItsPressure) {
  ControlBench bench("TGOV3", {{"PRMAX", 0.9}, {"K1", 0.3}, {"K2", 0.4}, {"K3", 0.3}, {"PMAX", 1.0}});
  ASSERT_EQ(bench.refused, "");
  bench.in.dPref = 1.0;
  bench.run(60.0, 5e-3);
  EXPECT_NEAR(bench.out().Tm, 0.3 + 0.7 * 0.9, 1e-6);
  bench.in.dPref = -0.5;
  bench.run(6.0, 5e-3);
  EXPECT_LT(bench.state("reheat"), 0.9);
  EXPECT_FALSE(ControlBench("TGOV3", {{"PRMAX", 0.0}}).problems.empty());
  const ControlBench powerless("TGOV3", {{"K1", 0.0}, {"K2", 0.0}, {"K3", 0.0}});
  ASSERT_EQ(powerless.problems.list().size(), 1u);
  EXPECT_EQ(powerless.problems.list()[0].what, "K1 = 0 pu with K2 = 0 pu, K3 = 0 pu");
}

TEST(GovernorSteamVariants, IeesgoSmallSignals) {
  const ControlBench::Changes values = {{"T1", 0.3}, {"T2", 0.1},  {"T3", 0.4}, {"T4", 0.6}, {"T5", 8.0},
                                        {"T6", 0.5}, {"K1", 18.0}, {"K2", 0.7}, {"K3", 0.4}};
  for (const double omega : {0.01, 0.1, 1.0, 10.0}) {
    ControlBench bench("IEESGO", values);
    ASSERT_TRUE(bench.problems.empty());
    EXPECT_LT(bench.largest_derivative(), 1e-14);
    const auto lag = [&](double T) { return lead_over_lag(0.0, T, omega); };
    const C asked = -18.0 * lag(0.3) * lead_over_lag(0.1, 0.4, omega), x4 = asked * lag(0.6),
            x5 = 0.7 * x4 * lag(8.0);
    const C exact = 0.3 * x4 + 0.6 * x5 + 0.4 * x5 * lag(0.5);
    const C h = bench.response(&Signals<double>::speed, &Signals<double>::Tm, omega);
    EXPECT_LT(std::abs(h - exact), 1e-7 * (1.0 + std::abs(exact))) << omega;
  }
}

TEST(GovernorSteamVariants, IeesgoLimitsItsPowerDemand) {
  ControlBench bench("IEESGO", {{"K1", 20.0}, {"db", 0.0005}});
  bench.in.speed = -0.0005;
  EXPECT_LT(bench.largest_derivative(), 1e-14);
  bench.in.speed = -0.1;
  bench.run(200.0, 1e-2);
  EXPECT_NEAR(bench.out().Tm, 1.0, 1e-6);
  EXPECT_NE(ControlBench("IEESGO", {{"PMAX", 0.7}}).refused.find("PMAX"), std::string::npos);
  EXPECT_FALSE(ControlBench("IEESGO", {{"T4", -0.1}}).problems.empty());
}

}  // namespace
}  // namespace swingbank::sim::test
