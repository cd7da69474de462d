// STAB2A: transfer function against its diagram and its limits.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
const ControlBench::Changes kStab2a = {{"K2", 1.1}, {"T2", 3.0}, {"K3", 0.8},  {"T3", 1.5},
                                       {"K4", 0.2}, {"K5", 1.2}, {"T5", 0.05}, {"HLIM", 0.05}};

TEST(StabiliserStab2a, TransferFunctionIsTheDiagrams) {
  for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
    ControlBench bench("STAB2A", kStab2a);
    ASSERT_TRUE(bench.problems.empty());
    EXPECT_EQ(bench.out().Vs, 0.0);
    EXPECT_LT(bench.largest_derivative(), 1e-14);
    const C s(0.0, omega), wash = 1.1 * 3.0 * s / (1.0 + 3.0 * s);
    const C out = 1.2 * lead_over_lag(0.0, 0.05, omega);
    const C exact = -wash * wash * wash * (0.8 * lead_over_lag(0.0, 1.5, omega) + 0.2) * out * out;
    EXPECT_LT(std::abs(bench.response(&Signals<double>::P, &Signals<double>::Vs, omega) - exact), 1e-7);
  }
}

TEST(StabiliserStab2a, OutputIsLimitedOnBothSides) {
  ControlBench bench("STAB2A", kStab2a);
  bench.in.P += 1.0;
  bench.run(0.5);
  EXPECT_EQ(bench.out().Vs, -0.05);
  bench.in.P -= 2.0;
  bench.run(0.5);
  EXPECT_EQ(bench.out().Vs, 0.05);
  EXPECT_FALSE(ControlBench("STAB2A", {{"T2", 0.0}}).problems.empty());
  EXPECT_FALSE(ControlBench("STAB2A", {{"HLIM", -1.0}}).problems.empty());
}

}  // namespace
}  // namespace swingbank::sim::test
