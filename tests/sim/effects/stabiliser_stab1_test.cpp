// STAB1: transfer function against its diagram, limits both ways, bypasses.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;

TEST(StabiliserStab1, TransferFunctionIsTheDiagrams) {
  for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
    ControlBench bench(
        "STAB1",
        {{"KT", 8.0}, {"TW", 3.0}, {"T1_T3", 6.0}, {"T3", 0.05}, {"T2_T4", 3.0}, {"T4", 0.1}, {"HLIM", 0.2}});
    ASSERT_TRUE(bench.problems.empty());
    EXPECT_EQ(bench.largest_derivative(), 0.0);
    const C s(0.0, omega);
    const C exact =
        8.0 * 3.0 * s / (1.0 + 3.0 * s) * lead_over_lag(0.3, 0.05, omega) * lead_over_lag(0.3, 0.1, omega);
    // difference quotients with step 1e-6, times a gain of up to 144
    EXPECT_LT(std::abs(bench.response(&Signals<double>::speed, &Signals<double>::Vs, omega) - exact), 1e-6);
  }
}

TEST(StabiliserStab1, LimitsBothSignsAndWashesOut) {
  ControlBench bench("STAB1", {{"HLIM", 0.05}});
  bench.in.speed = 0.02;
  EXPECT_EQ(bench.out().Vs, 0.05);
  bench.run(100.0);
  EXPECT_NEAR(bench.out().Vs, 0.0, 1e-8);  // washed out: 0.2 pu exp(-100 / 5)
  bench.in.speed = 0.0;
  EXPECT_EQ(bench.out().Vs, -0.05);
}

TEST(StabiliserStab1, ZeroTimeConstantsAreBypassed) {
  ControlBench bench("STAB1", {{"KT", 4.0}, {"T3", 0.0}, {"T4", 0.0}});
  bench.in.speed = 0.002;
  EXPECT_DOUBLE_EQ(bench.out().Vs, 0.008);
}

TEST(StabiliserStab1, RefusesUnsupportedParameters) {
  EXPECT_EQ(ControlBench("STAB1", {{"TW", 0.0}, {"T4", -1.0}, {"HLIM", -0.1}}).problems.list().size(), 3u);
}

}  // namespace
}  // namespace swingbank::sim::test
