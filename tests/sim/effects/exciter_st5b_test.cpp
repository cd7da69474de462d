// ST5B: transfer function against the diagram, limits that move with the voltage, release.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
using Values = ControlBench::Changes;

Values st5b_with(Values more) {
  Values v = {{"TR", 0.02},  {"TC1", 0.8}, {"TB1", 6.0},   {"TC2", 0.08},   {"TB2", 0.02},
              {"KR", 100.0}, {"T1", 0.04}, {"VRMAX", 5.0}, {"VRMIN", -4.0}, {"KC", 0.1}};
  for (const auto& [k, x] : more) v[k] = x;
  return v;
}

TEST(ExciterSt5b, TransferFunctionIsTheDiagrams) {
  for (const auto& more :
       {Values{}, {{"T1", 0.0}, {"TR", 0.0}}, {{"TB1", 0.0}, {"TC1", 0.0}}, {{"TC2", 0.0}}}) {
    const Values v = st5b_with(more);
    for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
      ControlBench bench("ST5B", v);
      ASSERT_TRUE(bench.problems.empty());
      ASSERT_EQ(bench.refused, "");
      EXPECT_LT(bench.largest_derivative(), 1e-11);  // rounding times KR/TB2
      const C out = lead_over_lag(0.0, v.at("T1"), omega);
      const C exact = 100.0 * lead_over_lag(v.at("TC1"), v.at("TB1"), omega) *
                      lead_over_lag(v.at("TC2"), v.at("TB2"), omega) * out;
      // difference quotients with step 1e-6, amplified by KR TC2/TB2 = 400
      EXPECT_LT(std::abs(bench.response(&Signals<double>::Vs, &Signals<double>::Efd, omega) - exact),
                1e-7 * (1.0 + std::abs(exact)));
      EXPECT_LT(std::abs(bench.response(&Signals<double>::Vc, &Signals<double>::Efd, omega) +
                         exact * lead_over_lag(0.0, v.at("TR"), omega)),
                1e-7 * (1.0 + std::abs(exact)));
      EXPECT_LT(std::abs(bench.response(&Signals<double>::Ifd, &Signals<double>::Efd, omega) + 0.1 * out),
                1e-8);
    }
  }
}

TEST(ExciterSt5b, CeilingsMoveWithTheVoltage) {
  ControlBench bench("ST5B", st5b_with({}));
  bench.in.dVref = 1.0;
  bench.run(10.0);
  EXPECT_NEAR(bench.out().Efd, 5.0 - 0.1 * 2.0, 1e-9);  // VRMAX minus the rectifier's drop
  bench.in.V = 0.6;
  bench.run(0.1);
  EXPECT_DOUBLE_EQ(bench.out().Efd, 0.6 * 5.0);
  bench.in.dVref = -1.0;
  bench.run(10.0);
  EXPECT_DOUBLE_EQ(bench.out().Efd, -0.6 * 4.0);
}

TEST(ExciterSt5b, IntegralsDoNotWindUp) {
  ControlBench bench("ST5B", st5b_with({}));
  bench.in.dVref = 1.0;
  bench.in.V = 0.6;
  bench.run(30.0);
  // excess over the limit V VRMAX: (VRMAX - KC Ifd - V VRMAX)/T1 divided by the return rate of 500/s
  EXPECT_LT(bench.state("Efd"), 3.0 + (5.0 - 0.2 - 3.0) / 0.04 / 500.0 + 1e-9);
  bench.in.dVref = -1.0;
  bench.run(0.1);  // the lead-lags leave their limits with TC1 + TC2, Efd with T1
  EXPECT_LT(bench.out().Efd, 0.0);
}

TEST(ExciterSt5b, RefusesOperatingPointBeyondItsLimits) {
  EXPECT_NE(ControlBench("ST5B", {{"VRMAX", 1.9}}).refused.find("VRMAX"), std::string::npos);
  EXPECT_EQ(ControlBench("ST5B", {{"KR", 0.0}, {"T1", -1.0}, {"KC", -1.0}, {"VRMAX", 0.5}, {"VRMIN", 0.5}})
                .problems.list()
                .size(),
            4u);
}

}  // namespace
}  // namespace swingbank::sim::test
