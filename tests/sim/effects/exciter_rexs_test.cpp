// REXS: transfer function against the diagram, step response against the equations integrated in this file,
// limits, refusals.
#include <algorithm>
#include <array>
#include <cmath>

#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
using Values = ControlBench::Changes;
constexpr auto kEfd = &Signals<double>::Efd;

/// All parts active except saturation and rectifier.
Values rexs_with(const Values& more) {
  Values v = {{"TR", 0.02}, {"KVP", 30.0}, {"KVI", 12.0}, {"VIMAX", 1.0}, {"TA", 0.03}, {"TB1", 4.0},
              {"TC1", 1.0}, {"TB2", 0.4},  {"TC2", 0.1},  {"KF", 0.04},   {"TF", 1.3},  {"TF1", 0.2},
              {"TF2", 0.1}, {"FBF", 1.0},  {"KIP", 1.5},  {"KII", 2.0},   {"TP", 0.05}, {"KH", 0.3},
              {"KE", 0.9},  {"TE", 0.8},   {"KC", 0.0},   {"KD", 0.4},    {"SE1", 0.0}, {"SE2", 0.0}};
  for (const auto& [k, x] : more) v[k] = x;
  return v;
}

TEST(ExciterRexs, TransferFunctionIsTheDiagrams) {
  for (const Values& more :
       {Values{},
        {{"FBF", 0.0}},
        {{"FBF", 2.0}},
        {{"KII", 0.0}, {"KVI", 0.0}, {"TP", 0.0}, {"TR", 0.0}},
        {{"KIP", 0.0}, {"KVP", 0.0}, {"TB1", 0.0}, {"TB2", 0.0}, {"TF2", 0.0}, {"TA", 0.0}},
        {{"KF", 0.0}, {"KH", 0.0}}}) {
    const Values v = rexs_with(more);
    const auto at = [&](const char* name) { return v.at(name); };
    for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
      ControlBench bench("REXS", v);
      ASSERT_TRUE(bench.problems.empty());
      ASSERT_EQ(bench.refused, "");
      EXPECT_LT(bench.largest_derivative(), 1e-10);
      EXPECT_NEAR(bench.out().Efd, 2.0, 1e-14);
      const C s(0.0, omega);
      const C regulator = (at("KVP") + at("KVI") / s) *
                          lead_over_lag(at("TB1") > 0 ? at("TC1") : 0, at("TB1"), omega) *
                          lead_over_lag(at("TB2") > 0 ? at("TC2") : 0, at("TB2"), omega) *
                          lead_over_lag(0.0, at("TA"), omega);
      const C current = (at("KIP") + at("KII") / s) * lead_over_lag(0.0, at("TP"), omega);
      const C alternator = 1.0 / (at("KE") + at("TE") * s);  // Vfield to Ve, which is Efd
      const C inner = current * alternator / (1.0 + current * alternator * at("KH") * at("KE"));  // Vr to Efd
      const C feedback = at("KF") * s / (1.0 + at("TF") * s) *
                         lead_over_lag(at("TF2") > 0 ? at("TF1") : 0, at("TF2"), omega);
      const C fed = at("FBF") == 0 ? C(1.0) : at("FBF") == 1 ? inner * at("KE") : inner;  // per unit of Vr
      const C exact = regulator * inner / (1.0 + regulator * feedback * fed);
      EXPECT_LT(std::abs(bench.response(&Signals<double>::Vs, kEfd, omega) - exact),
                1e-6 * (1.0 + std::abs(exact)));
      EXPECT_LT(std::abs(bench.response(&Signals<double>::Vc, kEfd, omega) +
                         exact * lead_over_lag(0.0, at("TR"), omega)),
                1e-6 * (1.0 + std::abs(exact)));
    }
  }
}

/// Independent implementation of the diagram's equations: limits clamp the states directly.
class Drawn {
 public:
  std::array<double, 9> x{};  ///< Vm, xv, first, second, Vr, rate, rate_lag, Vfield, Ve
  double Vref = 0.0, dVref = 0.0, V = 1.0, Ifd = 2.0;

  static double saturation(double ve) {  // through (3, 0.1) and (4, 0.4): B (ve - A)^2
    const double root = std::sqrt(3 * 0.1 / (4 * 0.4)), A = (3 - root * 4) / (1 - root),
                 B = 1.6 / ((4 - A) * (4 - A));
    return ve > A ? B * (ve - A) * (ve - A) : 0.0;
  }
  [[nodiscard]] double field() const { return field(x[8]); }
  [[nodiscard]] double field(double ve) const { return 0.9 * ve + saturation(ve) + 0.4 * Ifd; }
  [[nodiscard]] double Efd() const { return Efd(x[8]); }
  [[nodiscard]] double Efd(double ve) const {  // KC = 0.1
    if (ve <= 0) return 0.0;
    const double in = 0.1 * Ifd / ve;
    const double fex = in <= std::sqrt(3.0) / 4 ? 1 - in / std::sqrt(3.0)
                       : in <= 0.75             ? std::sqrt(0.75 - in * in)
                       : in <= 1                ? std::sqrt(3.0) * (1 - in)
                                                : 0.0;
    return ve * fex;
  }
  [[nodiscard]] std::array<double, 9> derivative(const std::array<double, 9>& y) const {
    std::array<double, 9> d{};
    const double Vfe = field(y[8]);
    const double washed = 0.04 / 1.3 * (Vfe - y[5]), Vf = y[6] + 0.2 * (washed - y[6]) / 0.1;
    const double e = std::clamp(Vref + dVref - y[0] - Vf, -0.15, 0.15);
    d[0] = (V - y[0]) / 0.02;
    d[1] = 12.0 * e;
    const double pi = 30.0 * e + y[1];
    d[2] = (pi - y[2]) / 4.0;
    const double u1 = y[2] + 1.0 * d[2];
    d[3] = (u1 - y[3]) / 0.4;
    const double u2 = y[3] + 0.1 * d[3];
    d[4] = limited_rate((u2 - y[4]) / 0.03, y[4], -2.0, 4.5);
    d[5] = (Vfe - y[5]) / 1.3;
    d[6] = (washed - y[6]) / 0.1;
    d[7] = limited_rate((1.5 * (y[4] - 0.3 * Vfe) - y[7]) / 0.05, y[7], -3.0, 5.0);
    d[8] = limited_rate((y[7] - Vfe) / 0.8, y[8], 0.0, 99.0);
    return d;
  }
  void step(double h) {
    auto k1 = derivative(x), k2 = derivative(plus(x, k1, h / 2)), k3 = derivative(plus(x, k2, h / 2)),
         k4 = derivative(plus(x, k3, h));
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    x[4] = std::clamp(x[4], -2.0, 4.5);
    x[7] = std::clamp(x[7], -3.0, 5.0);
    x[8] = std::max(x[8], 0.0);
  }

 private:
  static double limited_rate(double rate, double at, double low, double high) {
    return (at >= high && rate > 0) || (at <= low && rate < 0) ? 0.0 : rate;
  }
  static std::array<double, 9> plus(std::array<double, 9> y, const std::array<double, 9>& d, double h) {
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += h * d[i];
    return y;
  }
};

TEST(ExciterRexs, StepsFollowTheEquationsThroughTheirLimits) {
  ControlBench bench("REXS", rexs_with({{"KII", 0.0},
                                        {"KC", 0.1},
                                        {"E1", 3.0},
                                        {"SE1", 0.1},
                                        {"E2", 4.0},
                                        {"SE2", 0.4},
                                        {"VIMAX", 0.15},
                                        {"VRMAX", 4.5},
                                        {"VRMIN", -2.0},
                                        {"VFMAX", 5.0},
                                        {"VFMIN", -3.0}}));
  ASSERT_TRUE(bench.problems.empty());
  ASSERT_EQ(bench.refused, "");
  Drawn drawn;
  double low = 0.1, high = 5.0;  // bisection for Ve at Efd = 2
  for (int i = 0; i < 60; ++i) (drawn.Efd((low + high) / 2) < 2.0 ? low : high) = (low + high) / 2;
  const double Vfe = drawn.field(low), Vr = 0.3 * Vfe + Vfe / 1.5;
  drawn.x = {1.0, Vr, Vr, Vr, Vr, Vfe, 0.0, Vfe, low};
  drawn.Vref = 1.0;
  double most = 0.0, worst = 0.0, least = 9.0;
  for (int k = 0; k < 8000; ++k) {  // reference +0.2 for 1 s, -0.3 for 4 s, unchanged, then a sag
    const double t = 0.001 * k;
    bench.in.dVref = drawn.dVref = t < 1 ? 0.2 : t < 5 ? -0.3 : 0.0;
    bench.in.V = bench.in.Vc = drawn.V = t < 7 ? 1.0 : 0.8;
    drawn.step(0.001);
    bench.run(0.001, 2.5e-4);
    worst = std::max(worst, std::abs(bench.out().Efd - drawn.Efd()));
    most = std::max(most, bench.state("Vr"));
    least = std::min(least, bench.state("Vr"));
  }
  EXPECT_GT(most, 4.5);  // both limits of the regulator were reached
  EXPECT_LT(least, -2.0);
  // A lag leaves its limit within 2 ms in REXS, without delay in this copy; Efd swings by more than 2 pu.
  EXPECT_LT(worst, 0.01);
}

TEST(ExciterRexs, LimitsFollowTheVoltageInProportionToFlimf) {
  for (const double follow : {0.0, 0.5, 1.0}) {
    ControlBench bench(
        "REXS", rexs_with({{"VRMAX", 5.0}, {"KH", 0.0}, {"KII", 0.0}, {"KIP", 1.0}, {"FLIMF", follow}}));
    ASSERT_EQ(bench.refused, "");
    bench.in.dVref = 1.0;
    bench.in.V = 0.6;
    bench.run(20.0, 2e-3);
    const double factor = 1 - follow * 0.4;
    EXPECT_NEAR(bench.out().Efd, (5.0 * factor - 0.4 * 2.0) / 0.9, 1e-6);
  }
}

TEST(ExciterRexs, TheFieldsRegulatorStopsIntegratingAtItsLimit) {
  ControlBench bench("REXS", rexs_with({{"VFMAX", 4.0}, {"KH", 0.0}, {"KVI", 0.0}, {"TB1", 0.0}}));
  bench.in.dVref = 1.0;
  bench.run(20.0, 2e-3);
  EXPECT_NEAR(bench.out().Efd, (4.0 - 0.4 * 2.0) / 0.9, 1e-6);
  EXPECT_LT(bench.state("xi"), 4.0);  // Vr is above xi, so the integral did not wind up
  bench.in.dVref = -1.0;
  bench.run(2.0, 2e-3);
  EXPECT_LT(bench.out().Efd, 2.0);
}

TEST(ExciterRexs, RefusesOperatingPointBeyondItsLimits) {
  EXPECT_NE(ControlBench("REXS", {{"VFMAX", 1.0}}).refused.find("Vfield = 6.0"), std::string::npos);
  EXPECT_NE(ControlBench("REXS", {{"VRMAX", 1.0}}).refused.find("Vr = 6.0"), std::string::npos);
  EXPECT_NE(ControlBench("REXS", {{"KVP", 10.0}}).refused.find("an error of 0.6"), std::string::npos);
  EXPECT_EQ(ControlBench("REXS",
                         {{"KVP", 0.0}, {"KIP", 0.0}, {"TE", 0.0}, {"FBF", 0.0}, {"TA", 0.0}, {"VIMAX", 0.0}})
                .problems.list()
                .size(),
            5u);
  EXPECT_EQ(ControlBench("REXS", {{"TF", 0.0}, {"FBF", 3.0}, {"FLIMF", 2.0}}).problems.list().size(), 3u);
}

}  // namespace
}  // namespace swingbank::sim::test
