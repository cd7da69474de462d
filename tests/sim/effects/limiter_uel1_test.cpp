// UEL1: its circle in the P-Q plane, transfer function outside the circle, wind-up and return, refusals.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
using Values = ControlBench::Changes;

/// Signals of a machine at the phasor V that delivers P + jQ.
void deliver(Signals<double>& s, C V, C power) {
  const C I = std::conj(power / V);
  s.Vr = V.real();
  s.Vi = V.imag();
  s.V = s.Vc = std::abs(V);
  s.Ir = I.real();
  s.Ii = I.imag();
  s.P = power.real();
  s.Q = power.imag();
}

TEST(LimiterUel1, ActsOutsideItsCircleOnly) {
  // proportional part only
  const Values v = {{"KUI", 0.0}, {"KUL", 2.0}, {"TU2", 0.0}, {"VULMAX", 1.0}, {"KUR", 1.6}, {"KUC", 1.2}};
  for (const double magnitude : {0.85, 1.0, 1.1})
    for (const double P : {0.0, 0.5, 0.9}) {
      const double square = magnitude * magnitude;
      const double edge = 1.2 * square - std::sqrt(std::pow(1.6 * square, 2) - P * P);
      const C V = std::polar(magnitude, 0.7);
      ControlBench bench("UEL1", v);
      ASSERT_TRUE(bench.problems.empty());
      EXPECT_EQ(bench.refused, "");
      deliver(bench.in, V, {P, edge + 1e-6});
      EXPECT_EQ(bench.out().Vlimiter, 0.0);
      deliver(bench.in, V, {P, edge - 0.1});
      const double e = std::abs(C(P, edge - 0.1) - C(0.0, 1.2 * square)) / magnitude - 1.6 * magnitude;
      EXPECT_GT(e, 0.05);
      EXPECT_NEAR(bench.out().Vlimiter, 2.0 * e, 1e-14);  // rounding
    }
}

TEST(LimiterUel1, TransferFunctionIsTheDiagrams) {
  const Values v = {{"KUI", 3.0}, {"KUL", 0.7}, {"TU1", 0.3},    {"TU2", 0.05},
                    {"TU3", 0.2}, {"TU4", 0.6}, {"VUIMAX", 5.0}, {"VULMAX", 9.0}};
  for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
    ControlBench bench("UEL1", v);
    deliver(bench.in, std::polar(1.0, 0.3), {0.8, -0.9});
    bench.state("Vui") = 0.4;  // inside every limit
    bench.state("lead1") = bench.state("lead2") = 0.7;
    // derivative of |KUC V - j I| with respect to the imaginary part of the current
    const C phasor = 1.38 * C(bench.in.Vr, bench.in.Vi) - C(0.0, 1.0) * C(bench.in.Ir, bench.in.Ii);
    const C exact = phasor.real() / std::abs(phasor) * (0.7 + 3.0 / C(0.0, omega)) *
                    lead_over_lag(0.3, 0.05, omega) * lead_over_lag(0.2, 0.6, omega);
    const C found = bench.response(&Signals<double>::Ii, &Signals<double>::Vlimiter, omega);
    // difference quotients with step 1e-6, amplified 6 times by the leads
    EXPECT_LT(std::abs(found - exact), 1e-7 * (1.0 + std::abs(exact))) << omega;
  }
}

TEST(LimiterUel1, WindsUpToItsLimitAndReturnsFromThere) {
  ControlBench bench("UEL1", {{"KUI", 2.0}, {"KUL", 0.1}, {"VUIMAX", 0.2}, {"VULMAX", 0.22}});
  const double inside = std::abs(C(0.8, -1.38)) - 1.95;  // e at the rated point
  deliver(bench.in, 1.0, {0.8, -0.9});
  bench.run(5.0);
  EXPECT_EQ(bench.state("Vui"), 0.2);
  EXPECT_EQ(bench.out().Vlimiter, 0.22);  // 0.2 + 0.1 e exceeds the limit
  deliver(bench.in, 1.0, {0.8, 0.0});
  bench.run(0.1);
  EXPECT_NEAR(bench.state("Vui"), 0.2 + 2.0 * inside * 0.1, 1e-12);
  bench.run(5.0);
  EXPECT_EQ(bench.state("Vui"), 0.0);
  EXPECT_EQ(bench.out().Vlimiter, 0.0);
}

TEST(LimiterUel1, AddsToOtherLimiters) {
  ControlBench bench("UEL1", {{"KUI", 2.0}});
  bench.in.Vlimiter = -0.2;
  EXPECT_EQ(bench.out().Vlimiter, -0.2);
  deliver(bench.in, 1.0, {0.8, -0.9});
  bench.run(1.0);
  EXPECT_GT(bench.out().Vlimiter, -0.2);
}

TEST(LimiterUel1, RefusesUnsupportedParameters) {
  auto weak = ControlBench::rated();
  deliver(weak, 1.0, {0.8, -0.7});
  EXPECT_NE(ControlBench("UEL1", {}, weak).refused.find("Q = -0.7000 pu"), std::string::npos);
  EXPECT_EQ(ControlBench("UEL1", {{"KUF", 3.3}, {"VULMIN", -18.0}, {"KUR", 0.0}, {"VUIMIN", 0.1}})
                .problems.list()
                .size(),
            4u);
}

}  // namespace
}  // namespace swingbank::sim::test
