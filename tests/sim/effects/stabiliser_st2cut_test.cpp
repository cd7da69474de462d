// ST2CUT: transfer functions of both inputs against its diagram, limits and cut-off by voltage.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
const ControlBench::Changes kSt2cut = {
    {"MODE", 1.0}, {"MODE2", 3.0}, {"K1", 4.0},     {"K2", -0.7},     {"T1", 0.03}, {"T2", 0.2},
    {"T3", 3.0},   {"T4", 2.0},    {"T5", 0.1},     {"T6", 0.02},     {"T7", 0.15}, {"T8", 0.04},
    {"T9", 0.3},   {"T10", 0.2},   {"LSMAX", 10.0}, {"LSMIN", -10.0}, {"VCU", 0.0}, {"VCL", 0.0}};
C behind_the_sum(double omega) {
  const C s(0.0, omega);
  return 3.0 * s / (1.0 + 2.0 * s) * lead_over_lag(0.1, 0.02, omega) * lead_over_lag(0.15, 0.04, omega) *
         lead_over_lag(0.3, 0.2, omega);
}

TEST(StabiliserSt2cut, TransferFunctionsAreTheDiagrams) {
  for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
    ControlBench bench("ST2CUT", kSt2cut);
    ASSERT_TRUE(bench.problems.empty());
    EXPECT_EQ(bench.out().Vs, 0.0);
    EXPECT_LT(bench.largest_derivative(), 1e-14);
    const C speed = 4.0 * lead_over_lag(0.0, 0.03, omega) * behind_the_sum(omega),
            power = -0.7 * lead_over_lag(0.0, 0.2, omega) * behind_the_sum(omega);
    EXPECT_LT(std::abs(bench.response(&Signals<double>::speed, &Signals<double>::Vs, omega) - speed), 1e-6);
    EXPECT_LT(std::abs(bench.response(&Signals<double>::P, &Signals<double>::Vs, omega) - power), 1e-6);
  }
}

TEST(StabiliserSt2cut, WithoutT3TheWashoutIsALag) {
  ControlBench::Changes changes = kSt2cut;
  for (auto& [name, value] : changes)
    if (name == std::string("T3")) value = 0.0;
  ControlBench bench("ST2CUT", changes);
  EXPECT_NEAR(bench.out().Vs, -0.7 * bench.in.P, 1e-12);
  EXPECT_LT(bench.largest_derivative(), 1e-14);
}

TEST(StabiliserSt2cut, OutputIsLimitedAndCutOff) {
  ControlBench bench("ST2CUT", {{"LSMAX", 0.05}, {"VCU", 1.2}, {"VCL", 0.7}});
  bench.in.speed = 0.1;
  bench.run(0.2);
  EXPECT_EQ(bench.out().Vs, 0.05);
  for (const double V : {1.25, 0.65}) {
    bench.in.V = bench.in.Vc = V;
    EXPECT_EQ(bench.out().Vs, 0.0) << V;
  }
  EXPECT_FALSE(ControlBench("ST2CUT", {{"T4", 0.0}}).problems.empty());
  EXPECT_FALSE(ControlBench("ST2CUT", {{"MODE", 2.0}}).problems.empty());
  EXPECT_FALSE(ControlBench("ST2CUT", {{"LSMAX", -1.0}}).problems.empty());
}

}  // namespace
}  // namespace swingbank::sim::test
