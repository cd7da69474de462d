// IEEET1: transfer function against the diagram, ceiling by saturation, release, meaning of parameters equal
// to zero.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;

TEST(ExciterIeeet1, TransferFunctionIsTheDiagrams) {
  const ControlBench::Changes linear = {{"TR", 0.03}, {"KA", 60.0}, {"TA", 0.08}, {"KE", 0.9}, {"TE", 0.7},
                                        {"KF", 0.05}, {"TF", 0.9},  {"SE1", 0.0}, {"SE2", 0.0}};
  for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
    ControlBench bench("IEEET1", linear);
    ASSERT_TRUE(bench.problems.empty());
    EXPECT_LT(bench.largest_derivative(), 1e-11);  // rounding times KA/TA
    const C s(0.0, omega);
    const C forward = 60.0 * lead_over_lag(0.0, 0.08, omega) / (0.9 + 0.7 * s);
    const C closed = forward / (1.0 + forward * 0.05 * s / (1.0 + 0.9 * s));
    // difference quotients with step 1e-6, amplified by KA/TA = 750
    EXPECT_LT(std::abs(bench.response(&Signals<double>::Vs, &Signals<double>::Efd, omega) - closed), 1e-6);
    EXPECT_LT(std::abs(bench.response(&Signals<double>::Vc, &Signals<double>::Efd, omega) +
                       closed * lead_over_lag(0.0, 0.03, omega)),
              1e-6);
  }
}

TEST(ExciterIeeet1, CeilingIsWhereSaturationBalancesVrmaxAndReleaseIsImmediate) {
  ControlBench bench("IEEET1", {{"E1", 3.0}, {"SE1", 0.1}, {"E2", 4.0}, {"SE2", 0.3}, {"VRMAX", 5.2}});
  bench.in.dVref = 1.0;
  bench.run(30.0);  // above E2 the exciter settles with TE/(KE + slope) < 0.8 s
  EXPECT_EQ(bench.state("Vr"), 5.2);
  EXPECT_NEAR(bench.out().Efd, 4.0, 1e-12);  // 4 (1 + 0.3) = 5.2
  bench.in.dVref = -1.0;
  bench.run(0.001);
  EXPECT_LT(bench.state("Vr"), 5.2);
}

TEST(ExciterIeeet1, ZeroLimitsAndKeAreComputedAsInPsse) {
  // VRMAX = (0.5 + 1) x 5
  ControlBench limit("IEEET1", {{"VRMAX", 0.0}, {"VRMIN", -1.0}});
  limit.in.dVref = 5.0;
  limit.run(5.0);
  EXPECT_DOUBLE_EQ(limit.state("Vr"), 7.5);
  limit.in.dVref = -5.0;
  limit.run(5.0);
  EXPECT_DOUBLE_EQ(limit.state("Vr"), -7.5);
  // Vr starts at a tenth of VRMAX
  ControlBench self("IEEET1", {{"KE", 0.0}, {"VRMAX", 6.0}});
  EXPECT_DOUBLE_EQ(self.state("Vr"), 0.6);
  EXPECT_DOUBLE_EQ(self.out().Efd, 2.0);
  EXPECT_LT(self.largest_derivative(), 1e-11);
  // KE <= 0 does not enter VRMAX: 0.5 times 5
  ControlBench both("IEEET1", {{"KE", 0.0}, {"VRMAX", 0.0}});
  EXPECT_DOUBLE_EQ(both.state("Vr"), 0.25);
}

TEST(ExciterIeeet1, RefusesOperatingPointBeyondItsLimits) {
  EXPECT_NE(ControlBench("IEEET1", {{"VRMAX", 1.0}}).refused.find("Vr"), std::string::npos);
  EXPECT_EQ(ControlBench("IEEET1", {{"VRMAX", 0.0}, {"KE", 0.0}, {"SE1", 0.0}, {"SE2", 0.0}, {"TE", 0.0}})
                .problems.list()
                .size(),
            2u);
}

}  // namespace
}  // namespace swingbank::sim::test
