// UEL2: its lines in the P-Q plane, exponents of the voltage, lags, transfer function, refusals.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
using Values = ControlBench::Changes;

/// Proportional part only, without lags of P and V.
Values lines(const Values& changes = {}) {
  Values all = {{"KUI", 0.0}, {"KUL", 2.0}, {"TUV", 0.0}, {"TUP", 0.0}, {"VULMAX", 5.0}};
  for (const auto& [name, value] : changes) all[name] = value;
  return all;
}
/// Output of the limiter for a machine that delivers P + jQ at V.
double added(const Values& changes, double V, double P, double Q) {
  ControlBench bench("UEL2", lines(changes));
  EXPECT_TRUE(bench.problems.empty());
  EXPECT_EQ(bench.refused, "");
  bench.in.V = V;
  bench.in.P = P;
  bench.in.Q = Q;
  return bench.out().Vlimiter;
}

TEST(LimiterUel2, ActsBelowItsLinesOnly) {
  // The standard's lines through (0.3, -0.31), (0.6, -0.28), (0.9, -0.21) and (1.02, 0), read by hand.
  for (const auto& [P, least] : {std::pair{0.0, -0.31},
                                 {0.15, -0.31},
                                 {0.45, -0.295},
                                 {0.75, -0.245},
                                 {0.9, -0.21},
                                 {0.96, -0.105},
                                 {1.02, 0.0},
                                 {1.2, 0.0}}) {
    EXPECT_EQ(added({}, 1.0, P, least + 1e-9), 0.0) << P;
    EXPECT_NEAR(added({}, 1.0, P, least - 0.1), 0.2, 1e-12) << P;
  }
}

TEST(LimiterUel2, VoltageMovesTheLinesByItsExponents) {
  // P' = 0.45 and 0.75 on the lines, at 0.9 pu
  for (const double k1 : {0.0, 1.0, 2.0})
    for (const double k2 : {0.0, 1.0, 2.0})
      for (const auto& [P, least] : {std::pair{0.45, -0.295}, {0.75, -0.245}})
        EXPECT_NEAR(added({{"K1", k1}, {"K2", k2}}, 0.9, P * std::pow(0.9, k1), -0.5),
                    2.0 * (least * std::pow(0.9, k2) + 0.5), 1e-12)
            << k1 << " " << k2;
}

TEST(LimiterUel2, NegativePowerUsesAMirrorOrTheFirstLine) {
  const Values slope = {{"Q0", -0.5}, {"Q1", -0.2}};  // 1 pu/pu from (0, -0.5) on
  const auto with = [&](double quadrant) {
    Values all = slope;
    all["Qquad"] = quadrant;
    return all;
  };
  EXPECT_NEAR(added(with(0.0), 1.0, -0.2, -0.8), 2.0 * (-0.3 + 0.8), 1e-12);
  EXPECT_NEAR(added(with(1.0), 1.0, -0.2, -0.8), 2.0 * (-0.7 + 0.8), 1e-12);
}

TEST(LimiterUel2, TransferFunctionIsTheDiagrams) {
  const Values v = {{"KUI", 3.0}, {"KUL", 0.7}, {"TUQ", 0.4},    {"TU1", 0.3},   {"TU2", 0.05},
                    {"TU3", 0.2}, {"TU4", 0.6}, {"VUIMAX", 5.0}, {"VULMAX", 9.0}};
  const auto at_work = [&] {
    ControlBench bench("UEL2", v);
    bench.in.P = 0.75;
    bench.in.Q = -0.9;
    bench.state("Pf") = 0.75;
    bench.state("Qf") = -0.9;
    bench.state("Vui") = 0.4;  // inside every limit
    bench.state("lead1") = bench.state("lead2") = 0.7;
    return bench;
  };
  for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
    const C s(0.0, omega);
    const C behind = (0.7 + 3.0 / s) * lead_over_lag(0.3, 0.05, omega) * lead_over_lag(0.2, 0.6, omega);
    const C of_q = -behind / (1.0 + 0.4 * s);
    const C of_p = behind * (0.07 / 0.3) / (1.0 + 5.0 * s);  // slope from (0.6, -0.28) to (0.9, -0.21)
    // d(Q' Vf^2)/dV: P' = P/Vf^2 is filtered with TUP = 5 s, and Vf in both terms with TUV = 5 s
    const C of_v = behind / (1.0 + 5.0 * s) * (2.0 * -0.245 + (0.07 / 0.3) * (-2.0 * 0.75) / (1.0 + 5.0 * s));
    // difference quotients with step 1e-6, amplified 6 times by the leads
    const auto near = [&](const C& found, const C& exact, const char* of) {
      EXPECT_LT(std::abs(found - exact), 1e-7 * (1.0 + std::abs(exact))) << of << " " << omega;
    };
    near(at_work().response(&Signals<double>::Q, &Signals<double>::Vlimiter, omega), of_q, "Q");
    near(at_work().response(&Signals<double>::P, &Signals<double>::Vlimiter, omega), of_p, "P");
    near(at_work().response(&Signals<double>::V, &Signals<double>::Vlimiter, omega), of_v, "V");
  }
}

TEST(LimiterUel2, WindsUpToItsLimitAndReturnsFromThere) {
  ControlBench bench("UEL2", lines({{"KUI", 2.0}, {"KUL", 0.1}, {"VUIMAX", 0.2}, {"VULMAX", 0.22}}));
  bench.in.P = 0.75;
  bench.in.Q = -0.9;
  bench.run(5.0);
  EXPECT_EQ(bench.state("Vui"), 0.2);
  EXPECT_EQ(bench.out().Vlimiter, 0.22);  // 0.2 + 0.1 e exceeds the limit
  bench.in.Q = 0.0;
  bench.run(0.1);
  EXPECT_NEAR(bench.state("Vui"), 0.2 - 2.0 * 0.245 * 0.1, 1e-12);
  bench.run(5.0);
  EXPECT_EQ(bench.state("Vui"), 0.0);
  EXPECT_EQ(bench.out().Vlimiter, 0.0);
}

TEST(LimiterUel2, StaysFiniteNearZeroVoltage) { EXPECT_TRUE(std::isfinite(added({}, 0.0, 0.0, 0.0))); }

TEST(LimiterUel2, RefusesUnsupportedParameters) {
  auto weak = ControlBench::rated();
  weak.Q = -0.7;
  EXPECT_NE(ControlBench("UEL2", {}, weak).refused.find("Q = -0.7000 pu"), std::string::npos);
  EXPECT_EQ(ControlBench("UEL2", {{"KUF", 3.3}, {"KFB", 1.0}, {"VULMIN", -18.0}, {"K1", 0.5}, {"P2", 0.2}})
                .problems.list()
                .size(),
            5u);
  // a point beyond the end of the lines
  EXPECT_EQ(ControlBench("UEL2", {{"P6", 1.2}}).problems.list().size(), 1u);
  EXPECT_EQ(ControlBench("UEL2", {{"P1", 0.0},
                                  {"P2", 0.0},
                                  {"P3", 0.0},
                                  {"P4", 0.0},
                                  {"Q1", 0.0},
                                  {"Q2", 0.0},
                                  {"Q3", 0.0},
                                  {"Q4", 0.0}})
                .problems.list()
                .size(),
            1u);
  const Effect& uel2 = *library::compiled().find("UEL2");
  std::vector<double> p = uel2.default_parameters();
  EXPECT_EQ(uel2.remark(p.data()), "");
  p[static_cast<std::size_t>(uel2.parameter_index("Q4"))] = -0.1;
  EXPECT_NE(uel2.remark(p.data()).find("stays -0.1 pu"), std::string::npos);
}

}  // namespace
}  // namespace swingbank::sim::test
