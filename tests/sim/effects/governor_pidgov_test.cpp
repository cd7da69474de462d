// PIDGOV: transfer function against the diagram, both feedbacks, droop at rest, limits, the curve.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
using Values = ControlBench::Changes;

Values pidgov_with(Values more) {
  Values v = {{"RPERM", 0.04}, {"TREG", 0.1},  {"KP", 2.0},  {"KI", 0.6}, {"KD", 0.3},  {"TA", 0.06},
              {"TB", 0.25},    {"DTURB", 0.4}, {"G0", 0.1},  {"G1", 0.5}, {"P1", 0.4},  {"G2", 0.7},
              {"P2", 0.7},     {"P3", 1.06},   {"ATW", 1.2}, {"TW", 0.8}, {"FLAG", 1.0}};
  for (const auto& [k, x] : more) v[k] = x;
  return v;
}

TEST(GovernorPidgov, TransferFunctionIsTheDiagrams) {
  for (const auto& more : {Values{}, {{"TREG", 0.0}, {"TW", 0.0}}, {{"KI", 0.0}}, {{"FLAG", 0.0}}}) {
    const Values v = pidgov_with(more);
    for (const double omega : {0.01, 0.1, 1.0, 10.0}) {
      ControlBench bench("PIDGOV", v);
      ASSERT_TRUE(bench.problems.empty());
      ASSERT_EQ(bench.refused, "");
      EXPECT_LT(bench.largest_derivative(), 1e-13);
      EXPECT_NEAR(bench.out().Tm, 0.8, 1e-14);
      const C s(0.0, omega);
      const auto lag = [&](double T) { return lead_over_lag(0.0, T, omega); };
      const C regulator =
          ((v.at("KP") + v.at("KI") / s) * lag(0.06) + 0.3 * s * lag(0.06)) * lag(0.06) * lag(0.25);
      const C back = v.at("FLAG") * 0.04 * lag(v.at("TREG"));
      const C turbine = 0.36 / 0.3 * lead_over_lag(-1.2 * v.at("TW"), 0.6 * v.at("TW"), omega);
      const C gate = regulator / (1.0 + regulator * back);
      const C exact = -gate * turbine - 0.4;
      const C h = bench.response(&Signals<double>::speed, &Signals<double>::Tm, omega);
      EXPECT_LT(std::abs(h - exact), 1e-7 * (1.0 + std::abs(exact))) << omega;
      const C moved = 0.04 * lag(v.at("TREG")) * gate * turbine;
      const C m = bench.response(&Signals<double>::dPref, &Signals<double>::Tm, omega);
      EXPECT_LT(std::abs(m - moved), 1e-7 * (1.0 + std::abs(moved))) << omega;
      if (v.at("FLAG") == 0.0) {
        const C fed = bench.response(&Signals<double>::P, &Signals<double>::Tm, omega);
        EXPECT_LT(std::abs(fed + moved), 1e-7 * (1.0 + std::abs(moved))) << omega;
      }
    }
  }
}

TEST(GovernorPidgov, SteadyStateGateFollowsTheDroop) {
  ControlBench bench("PIDGOV", pidgov_with({{"DTURB", 0.0}}));
  const double before = bench.state("gate");
  EXPECT_NEAR(before, 0.7 + 0.1 * 0.3 / 0.36, 1e-14);
  bench.in.speed = 0.004;  // down by 0.1, within the same segment
  bench.in.dPref = 0.05;   // and up by 0.05
  bench.run(600.0, 1e-2);
  EXPECT_NEAR(bench.state("gate"), before - 0.05, 1e-6);
}

TEST(GovernorPidgov, GateRespectsVelocityAndPositionLimits) {
  ControlBench bench("PIDGOV",
                     pidgov_with({{"VELMAX", 0.1}, {"VELMIN", -0.15}, {"GMAX", 0.9}, {"GMIN", 0.2}}));
  const double before = bench.state("gate");
  bench.in.speed = 0.5;
  bench.run(1.0);
  const double first = bench.state("gate");
  bench.run(1.0);
  EXPECT_NEAR(first - bench.state("gate"), 0.15, 1e-9);
  EXPECT_LT(first, before);
  bench.run(10.0);
  EXPECT_EQ(bench.state("gate"), 0.2);
  // power at gate 0.2, once the water column has settled: (0.2 - 0.1) x 0.4/0.4
  EXPECT_NEAR(bench.out().Tm, 0.1 - 0.4 * 0.5, 1e-6);
  ControlBench up("PIDGOV", pidgov_with({{"VELMAX", 0.1}, {"GMAX", 0.9}}));
  up.in.speed = -0.5;
  up.run(1.0);
  const double rising = up.state("gate");
  up.run(0.2);
  EXPECT_LE(up.state("gate") - rising, 0.02 + 1e-9);
  up.run(10.0);
  EXPECT_EQ(up.state("gate"), 0.9);
}

TEST(GovernorPidgov, RefusesParametersThatCannotBeIntegrated) {
  EXPECT_NE(ControlBench("PIDGOV", pidgov_with({{"GMAX", 0.6}})).refused.find("gate"), std::string::npos);
  EXPECT_EQ(ControlBench("PIDGOV",
                         {{"FLAG", 2.0}, {"TA", 0.0}, {"VELMIN", 0.1}, {"KI", 0.0}, {"KP", 0.0}, {"G1", 0.9}})
                .problems.list()
                .size(),
            5u);
}

}  // namespace
}  // namespace swingbank::sim::test
