// EXAC1: transfer function against the diagram, ceiling and release, refusals.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;

TEST(ExciterExac1, TransferFunctionIsTheDiagramsWithALoadedRectifier) {
  const ControlBench::Changes values = {{"TR", 0.02}, {"TB", 0.1},  {"TC", 0.3}, {"KA", 150.0}, {"TA", 0.05},
                                        {"TE", 0.9},  {"KF", 0.04}, {"TF", 0.8}, {"KC", 0.1},   {"KD", 0.3},
                                        {"KE", 1.1},  {"SE1", 0.0}, {"SE2", 0.0}};
  for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
    ControlBench bench("EXAC1", values);
    ASSERT_TRUE(bench.problems.empty());
    ASSERT_EQ(bench.refused, "");
    EXPECT_LT(bench.largest_derivative(), 1e-10);  // rounding times KA/TA
    EXPECT_NEAR(bench.out().Efd, 2.0, 1e-14);
    const C s(0.0, omega);
    const C forward =
        150.0 * lead_over_lag(0.3, 0.1, omega) * lead_over_lag(0.0, 0.05, omega) / (1.1 + 0.9 * s);
    const C rate = 0.04 * s / (1.0 + 0.8 * s);
    const C closed = forward / (1.0 + forward * 1.1 * rate);
    // difference quotients with step 1e-6, amplified by KA/TA = 3000
    EXPECT_LT(std::abs(bench.response(&Signals<double>::Vs, &Signals<double>::Efd, omega) - closed), 1e-5);
    // Field current acts through KC/sqrt(3) without delay (first mode) and through KD, alternator and
    // feedback.
    const C load =
        -0.1 / std::sqrt(3.0) - 0.3 * (1.0 / (1.1 + 0.9 * s) + forward * rate) / (1.0 + forward * 1.1 * rate);
    EXPECT_LT(std::abs(bench.response(&Signals<double>::Ifd, &Signals<double>::Efd, omega) - load), 1e-5);
  }
}

TEST(ExciterExac1, CeilingAndRelease) {
  ControlBench bench("EXAC1", {{"KC", 0.1}, {"SE1", 0.0}, {"SE2", 0.0}});
  bench.in.dVref = 0.5;
  bench.run(30.0);  // 37 TE
  EXPECT_EQ(bench.state("Vr"), 6.03);
  EXPECT_NEAR(bench.state("Ve"), 6.03 - 0.38 * 2.0, 1e-8);
  bench.in.dVref = -0.5;
  bench.run(0.01);
  EXPECT_LT(bench.state("Vr"), 6.03);
  bench.run(20.0);
  EXPECT_EQ(bench.out().Efd, 0.0);  // the rectifier does not reverse
}

TEST(ExciterExac1, RefusesOperatingPointBeyondItsLimits) {
  auto reversed = ControlBench::rated();
  reversed.Efd = -0.1;
  EXPECT_NE(ControlBench("EXAC1", {}, reversed).refused.find("Efd = -0.1000 pu"), std::string::npos);
  EXPECT_NE(ControlBench("EXAC1", {{"VRMAX", 1.0}}).refused.find("Vr"), std::string::npos);
  EXPECT_EQ(ControlBench("EXAC1", {{"TE", 0.0}, {"KC", -0.1}}).problems.list().size(), 2u);
}

}  // namespace
}  // namespace swingbank::sim::test
