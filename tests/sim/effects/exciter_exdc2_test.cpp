// EXDC2: transfer function against the diagram, voltage-dependent ceiling and limits, meaning of parameters
// equal to zero.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
using Values = ControlBench::Changes;

TEST(ExciterExdc2, TransferFunctionIsTheDiagrams) {
  const Values linear = {{"TR", 0.03}, {"KA", 60.0}, {"TA", 0.08}, {"TB", 2.0},  {"TC", 0.5}, {"KE", 0.9},
                         {"TE", 0.7},  {"KF", 0.05}, {"TF", 0.9},  {"SE1", 0.0}, {"SE2", 0.0}};
  for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
    ControlBench bench("EXDC2", linear);
    ASSERT_TRUE(bench.problems.empty());
    ASSERT_EQ(bench.refused, "");
    EXPECT_LT(bench.largest_derivative(), 1e-11);  // rounding times KA/TA
    const C s(0.0, omega);
    const C forward =
        60.0 * lead_over_lag(0.5, 2.0, omega) * lead_over_lag(0.0, 0.08, omega) / (0.9 + 0.7 * s);
    const C closed = forward / (1.0 + forward * 0.05 * s / (1.0 + 0.9 * s));
    // difference quotients with step 1e-6, amplified by KA/TA = 750
    EXPECT_LT(std::abs(bench.response(&Signals<double>::Vs, &Signals<double>::Efd, omega) - closed), 1e-6);
    EXPECT_LT(std::abs(bench.response(&Signals<double>::Vc, &Signals<double>::Efd, omega) +
                       closed * lead_over_lag(0.0, 0.03, omega)),
              1e-6);
  }
}

TEST(ExciterExdc2, CeilingIsWhereSaturationBalancesVrmaxTimesV) {
  ControlBench bench("EXDC2", {{"E1", 3.0}, {"SE1", 0.1}, {"E2", 4.0}, {"SE2", 0.3}, {"VRMAX", 6.5}});
  bench.in.V = 0.8;
  bench.in.dVref = 1.0;
  bench.run(30.0);                           // above E2 the exciter settles with TE/(KE + slope) < 0.8 s
  EXPECT_NEAR(bench.out().Efd, 4.0, 1e-12);  // 4 (1 + 0.3) = 0.8 x 6.5
  bench.in.dVref = -1.0;
  bench.in.V = 0.5;
  bench.run(30.0);
  EXPECT_NEAR(bench.out().Efd, -0.5 * 7.3, 1e-12);  // unsaturated below zero
}

/// The regulator alone: error straight into KA/(1 + s TA).
const Values kRegulator = {{"TR", 0.0}, {"TB", 0.0},    {"KF", 0.0},    {"KA", 40.0},
                           {"TA", 0.1}, {"VRMAX", 6.0}, {"VRMIN", -6.0}};

TEST(ExciterExdc2, ReleaseIsThatOfALimiterWithoutWindUp) {
  ControlBench bench("EXDC2", kRegulator);
  const double rest = bench.state("Vr");
  bench.in.dVref = 1.0;
  bench.run(2.0, 1e-4);
  bench.in.dVref = -1.0;
  bench.run(0.01, 1e-4);
  // Vr falls from 6 pu towards rest - 40 with the time constant TA, delayed by at most 2 ms.
  const auto falling = [&](double t) { return 6.0 + (rest - 40.0 - 6.0) * (1.0 - std::exp(-t / 0.1)); };
  EXPECT_GE(bench.state("Vr"), falling(0.01));
  EXPECT_LE(bench.state("Vr"), falling(0.008));
}

TEST(ExciterExdc2, FallingLimitPullsTheRegulatorDown) {
  ControlBench bench("EXDC2", kRegulator);
  const double rest = bench.state("Vr");
  bench.in.dVref = 0.2;
  bench.run(2.0, 1e-4);
  bench.in.V = 0.5;  // Vc is kept, so that the error stays constant
  bench.run(0.03, 1e-4);
  // the limit pulls Vr to 3 pu; the input of its lag keeps it higher by (rest + 8 - 3)/(500 TA + 1)
  EXPECT_NEAR(bench.state("Vr"), 3.0 + (rest + 8.0 - 3.0) / 51.0, 1e-5);  // 3 pu exp(-0.03 x 510)
  bench.in.V = 1.0;
  bench.run(0.02, 1e-4);
  EXPECT_LT(bench.state("Vr"), 5.0);  // rises again with TA: 3.2 + 7.5 (1 - exp(-0.2)) = 4.5
  EXPECT_GT(bench.state("Vr"), 4.0);
}

TEST(ExciterExdc2, ZeroLimitsAndKeAreComputedAsInPsse) {
  ControlBench limit("EXDC2", {{"VRMAX", 0.0}, {"VRMIN", -1.0}});  // VRMAX = (0.5 + 1) x 5
  limit.in.dVref = 5.0;
  limit.run(60.0);
  const double efd = limit.out().Efd;  // solution of 7.5 = Efd + B (Efd - A)^2: E2
  EXPECT_NEAR(efd, 5.0, 1e-12);
  ControlBench self("EXDC2", {{"KE", 0.0}, {"VRMAX", 6.0}});
  EXPECT_DOUBLE_EQ(self.state("Vr"), 0.6);
  EXPECT_DOUBLE_EQ(self.out().Efd, 2.0);
  EXPECT_LT(self.largest_derivative(), 1e-11);  // rounding times KA/TA
}

TEST(ExciterExdc2, RefusesOperatingPointBeyondItsLimits) {
  EXPECT_NE(ControlBench("EXDC2", {{"VRMAX", 1.0}}).refused.find("Vr = 2.0"), std::string::npos);
  EXPECT_EQ(ControlBench("EXDC2", {{"VRMAX", 0.0}, {"KE", 0.0}, {"SE1", 0.0}, {"SE2", 0.0}, {"TE", 0.0}})
                .problems.list()
                .size(),
            2u);
}

}  // namespace
}  // namespace swingbank::sim::test
