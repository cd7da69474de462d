// EXST1: transfer function against its diagram, limits of the error and ceilings that follow V and Ifd.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
const ControlBench::Changes kExst1Values = {{"TR", 0.02},   {"TC", 1.0},  {"TB", 5.0},    {"KA", 150.0},
                                            {"TA", 0.05},   {"KF", 0.03}, {"TF", 0.8},    {"VRMAX", 6.0},
                                            {"VRMIN", 0.0}, {"KC", 0.1},  {"VIMAX", 0.2}, {"VIMIN", -0.1}};

TEST(ExciterExst1, TransferFunctionIsTheDiagrams) {
  for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
    ControlBench bench("EXST1", kExst1Values);
    EXPECT_LT(bench.largest_derivative(), 1e-12);  // rounding times KA/TA with TA = 0.05 s
    const C forward = 150.0 * lead_over_lag(1.0, 5.0, omega) * lead_over_lag(0.0, 0.05, omega);
    const C back = C(0.0, omega) * 0.03 * lead_over_lag(0.0, 0.8, omega);
    const C closed = forward / (1.0 + forward * back);
    // difference quotients with step 1e-6, amplified by KA/TA = 3000
    EXPECT_LT(std::abs(bench.response(&Signals<double>::Vs, &Signals<double>::Efd, omega) - closed), 1e-5);
    EXPECT_LT(std::abs(bench.response(&Signals<double>::Vc, &Signals<double>::Efd, omega) +
                       closed * lead_over_lag(0.0, 0.02, omega)),
              1e-5);
  }
}

TEST(ExciterExst1, CeilingsFollowVoltageAndFieldCurrent) {
  ControlBench bench("EXST1", kExst1Values);
  bench.in.dVref = 0.1;
  bench.in.V = 0.9;
  bench.in.Ifd = 3.0;
  bench.run(30.0);
  EXPECT_DOUBLE_EQ(bench.out().Efd, 0.9 * 6.0 - 0.1 * 3.0);
  bench.in.dVref = -0.2;
  bench.run(30.0);
  EXPECT_DOUBLE_EQ(bench.out().Efd, -0.1 * 3.0);
}

TEST(ExciterExst1, ErrorIsLimitedBeforeTheLeadLag) {
  ControlBench bench("EXST1", kExst1Values);
  bench.in.dVref = 5.0;
  bench.run(100.0);
  EXPECT_NEAR(bench.state("Va"), 150.0 * 0.2, 1e-5);  // 30 exp(-100 / 5) = 6e-8; feedback is washed out
  bench.in.dVref = -5.0;
  bench.run(100.0);
  EXPECT_NEAR(bench.state("Va"), -150.0 * 0.1, 1e-5);
}

}  // namespace
}  // namespace swingbank::sim::test
