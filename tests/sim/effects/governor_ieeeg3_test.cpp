// IEEEG2 and IEEEG3: transfer functions against the diagrams, droop at rest, limits.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
using Values = ControlBench::Changes;

Values ieeeg2_with(const Values& more) {
  Values v = {{"K", 18.0}, {"T1", 0.4}, {"T2", 2.0}, {"T3", 7.0}, {"T4", 1.4}};
  for (const auto& [name, x] : more) v[name] = x;
  return v;
}

TEST(GovernorIeeeg2, TransferFunctionIsTheDiagrams) {
  for (const auto& more : {Values{}, {{"T1", 0.0}}, {{"T3", 0.0}}, {{"T4", 0.0}}})
    for (const double omega : {0.05, 0.5, 5.0}) {
      const Values v = ieeeg2_with(more);
      ControlBench bench("IEEEG2", v);
      ASSERT_TRUE(bench.problems.empty());
      ASSERT_EQ(bench.refused, "");
      EXPECT_EQ(bench.largest_derivative(), 0.0);
      const C water = lead_over_lag(-v.at("T4"), v.at("T4") / 2.0, omega);
      const C governor = 18.0 * lead_over_lag(0.0, v.at("T1"), omega) *
                         (v.at("T3") > 0.0 ? lead_over_lag(2.0, v.at("T3"), omega) : C(1.0));
      const C exact = -governor * water;
      EXPECT_LT(std::abs(bench.response(&Signals<double>::speed, &Signals<double>::Tm, omega) - exact),
                1e-8 * (1.0 + std::abs(exact)));
      EXPECT_LT(std::abs(bench.response(&Signals<double>::dPref, &Signals<double>::Tm, omega) - water), 1e-8);
    }
}

TEST(GovernorIeeeg2, GateStaysWithinItsLimits) {
  ControlBench bench("IEEEG2", ieeeg2_with({{"PMIN", 0.2}, {"PMAX", 0.9}}));
  bench.in.speed = 0.05;
  bench.run(60.0, 1e-2);
  EXPECT_NEAR(bench.out().Tm, 0.2, 1e-9);
  bench.in.speed = -0.05;
  bench.run(60.0, 1e-2);
  EXPECT_NEAR(bench.out().Tm, 0.9, 1e-9);
  EXPECT_NE(ControlBench("IEEEG2", ieeeg2_with({{"PMAX", 0.7}})).refused.find("PMAX"), std::string::npos);
  EXPECT_EQ(ControlBench("IEEEG2", {{"K", -1.0}, {"PMAX", 0.1}, {"PMIN", 0.1}}).problems.list().size(), 2u);
}

Values ieeeg3_with(const Values& more) {
  Values v = {{"TG", 0.4},  {"TP", 0.06}, {"SIGMA", 0.05}, {"DELTA", 0.4}, {"TR", 8.0},  {"TW", 1.3},
              {"A11", 0.6}, {"A13", 1.1}, {"A21", 1.4},    {"A23", 1.2},   {"UO", 0.15}, {"UC", -0.2}};
  for (const auto& [name, x] : more) v[name] = x;
  return v;
}

TEST(GovernorIeeeg3, TransferFunctionIsTheDiagrams) {
  for (const auto& more : {Values{}, {{"TP", 0.0}}, {{"TR", 0.0}}, {{"TW", 0.0}}, {{"SIGMA", 0.0}}})
    for (const double omega : {0.02, 0.3, 4.0}) {
      const Values v = ieeeg3_with(more);
      ControlBench bench("IEEEG3", v);
      ASSERT_TRUE(bench.problems.empty());
      ASSERT_EQ(bench.refused, "");
      EXPECT_EQ(bench.largest_derivative(), 0.0);
      EXPECT_NEAR(bench.state("gate"), 0.8 / 1.2, 1e-15);
      const C s(0.0, omega);
      const C servo = lead_over_lag(0.0, v.at("TP"), omega) / (0.4 * s);
      const C back = v.at("SIGMA") + (v.at("TR") > 0 ? 0.4 * s * 8.0 / (1.0 + s * 8.0) : C(0.0));
      const C water = 1.2 * lead_over_lag((0.6 - 1.1 * 1.4 / 1.2) * v.at("TW"), 0.6 * v.at("TW"), omega);
      const C exact = -servo / (1.0 + servo * back) * water;
      EXPECT_LT(std::abs(bench.response(&Signals<double>::speed, &Signals<double>::Tm, omega) - exact),
                1e-8 * (1.0 + std::abs(exact)));
      EXPECT_LT(std::abs(bench.response(&Signals<double>::dPref, &Signals<double>::Tm, omega) +
                         v.at("SIGMA") * exact),
                1e-8 * (1.0 + std::abs(exact)));
    }
}

TEST(GovernorIeeeg3, SteadyStateGateFollowsTheDroop) {
  ControlBench bench("IEEEG3", ieeeg3_with({}));
  bench.in.speed = 0.005;
  bench.in.dPref = 0.03;
  bench.run(900.0, 1e-2);
  EXPECT_NEAR(bench.state("gate"), 0.8 / 1.2 - 0.1 + 0.03, 1e-6);
  EXPECT_NEAR(bench.out().Tm, 1.2 * (0.8 / 1.2 - 0.07), 1e-6);
}

TEST(GovernorIeeeg3, GateRespectsVelocityAndPositionLimits) {
  for (const double lag : {0.0, 0.06}) {
    ControlBench bench("IEEEG3", ieeeg3_with({{"PMIN", 0.1}, {"PMAX", 0.95}, {"TP", lag}}));
    bench.in.speed = 0.3;
    bench.run(1.0);
    const double first = bench.state("gate");
    bench.run(0.5);
    EXPECT_NEAR(first - bench.state("gate"), 0.1, 1e-9);
    bench.run(10.0);
    EXPECT_EQ(bench.state("gate"), 0.1);
    bench.in.speed = -0.3;
    bench.run(1.0);
    const double rising = bench.state("gate");
    bench.run(0.5);
    EXPECT_NEAR(bench.state("gate") - rising, 0.075, 1e-9);
    bench.run(10.0);
    EXPECT_EQ(bench.state("gate"), 0.95);
  }
}

TEST(GovernorIeeeg3, RefusesParametersThatCannotBeIntegrated) {
  EXPECT_NE(ControlBench("IEEEG3", ieeeg3_with({{"PMAX", 0.6}})).refused.find("gate"), std::string::npos);
  EXPECT_EQ(
      ControlBench("IEEEG3", {{"TG", 0.0}, {"UC", 0.1}, {"A11", 0.0}, {"TP", -1.0}}).problems.list().size(),
      4u);
  EXPECT_TRUE(ControlBench("IEEEG3", {{"A11", 0.0}, {"TW", 0.0}}).problems.empty());
}

}  // namespace
}  // namespace swingbank::sim::test
