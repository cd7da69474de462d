// IEEET3: transfer function against the diagram, compound source, its limit at high field current.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
using Values = ControlBench::Changes;

/// Contribution of the source at `field` current, for the bench's 0.8 pu of current in phase with V.
double added(double V, double field) {
  const double ve = std::abs(C(1.19 * V, 1.86 * 0.8));
  return std::sqrt(ve * ve - std::pow(0.78 * field, 2));
}

TEST(ExciterIeeet3, TransferFunctionIsTheDiagrams) {
  for (const double TA : {0.15, 0.0})
    for (const double omega : {0.1, 1.0, 7.0}) {
      ControlBench bench("IEEET3", {{"TR", 0.03}, {"TA", TA}, {"KE", 0.9}});
      ASSERT_TRUE(bench.problems.empty());
      ASSERT_EQ(bench.refused, "");
      EXPECT_LT(bench.largest_derivative(), 1e-12);
      EXPECT_NEAR(bench.state("Vr"), 1.8 - added(1.0, 2.0), 1e-14);
      const C s(0.0, omega);
      const C regulator = 120.0 * lead_over_lag(0.0, TA, omega), exciter = 1.0 / (0.5 * s + 0.9);
      const C back = 0.02 * s / (1.0 + 0.53 * s);
      const C exact = regulator * exciter / (1.0 + regulator * exciter * back);
      EXPECT_LT(std::abs(bench.response(&Signals<double>::Vs, &Signals<double>::Efd, omega) - exact),
                1e-7 * (1.0 + std::abs(exact)));
      EXPECT_LT(std::abs(bench.response(&Signals<double>::Vc, &Signals<double>::Efd, omega) +
                         exact * lead_over_lag(0.0, 0.03, omega)),
                1e-7 * (1.0 + std::abs(exact)));
      const C by_field =
          exciter / (1.0 + regulator * exciter * back) * (-0.78 * 0.78 * 2.0 / added(1.0, 2.0));
      EXPECT_LT(std::abs(bench.response(&Signals<double>::Ifd, &Signals<double>::Efd, omega) - by_field),
                1e-7 * (1.0 + std::abs(exact)));
    }
}

TEST(ExciterIeeet3, SourceFollowsVoltageAndCurrentAndIsLimited) {
  ControlBench bench("IEEET3", {{"KF", 0.0}});
  bench.in.dVref = -1.0;  // Vr goes to its lower limit
  bench.in.V = bench.in.Vr = 1.2;
  bench.run(20.0, 5e-3);
  EXPECT_NEAR(bench.out().Efd, std::max(0.0, added(1.2, 2.0) - 1.2), 1e-6);
  bench.in.dVref = 1.0;
  bench.run(20.0, 5e-3);
  EXPECT_NEAR(bench.out().Efd, std::min(2.82, added(1.2, 2.0) + 1.2), 1e-6);
  bench.in.Ifd = 3.0;  // 0.78 Ifd beyond VE
  bench.run(20.0, 5e-3);
  EXPECT_NEAR(bench.out().Efd, 0.0, 1e-6);
}

TEST(ExciterIeeet3, RefusesParametersThatCannotBeIntegrated) {
  Signals<double> at = ControlBench::rated();
  at.Ifd = 3.0;
  EXPECT_NE(ControlBench("IEEET3", {}, at).refused.find("consumes the source voltage"), std::string::npos);
  EXPECT_NE(ControlBench("IEEET3", {{"VBMAX", 1.9}}).refused.find("VB = 2.0"), std::string::npos);
  EXPECT_NE(ControlBench("IEEET3", {{"VRMAX", 0.5}}).refused.find("Vr"), std::string::npos);
  EXPECT_EQ(
      ControlBench("IEEET3", {{"TE", 0.0}, {"KA", 0.0}, {"KP", 0.0}, {"VRMAX", -2.0}}).problems.list().size(),
      4u);
}

}  // namespace
}  // namespace swingbank::sim::test
