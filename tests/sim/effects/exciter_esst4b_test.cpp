// ESST4B: the source against its phasor definition, transfer function against the diagram, limits of both
// regulators and their release, refusals.
#include <numbers>

#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
using Values = ControlBench::Changes;
constexpr auto kEsst4bEfd = &Signals<double>::Efd;

/// Parameters with nonzero KP, KI, KC, XL and THETAP.
Values esst4b_with(Values more) {
  Values v = {{"TR", 0.02}, {"KPR", 3.0},     {"KIR", 4.0},  {"TA", 0.05}, {"KPM", 0.6},
              {"KIM", 2.0}, {"KG", 0.15},     {"KP", 6.0},   {"KI", 0.4},  {"KC", 0.1},
              {"XL", 0.08}, {"THETAP", 20.0}, {"VRMAX", 9.0}};
  for (const auto& [k, x] : more) v[k] = x;
  return v;
}
/// Source voltage VB for these values by IEEE Std 421.5, from the bench's phasors V and I; FEX is in its
/// first region.
double source(const Signals<double>& s) {
  const C V(s.Vr, s.Vi), I(s.Ir, s.Ii), kp = std::polar(6.0, 20.0 * std::numbers::pi / 180.0);
  const double ve = std::abs(kp * V + C(0.0, 1.0) * (0.4 + kp * 0.08) * I);
  return ve * (1.0 - 0.1 * s.Ifd / ve / std::sqrt(3.0));
}

TEST(ExciterEsst4b, TransferFunctionIsTheDiagrams) {
  for (const auto& more : {Values{},
                           {{"KIM", 0.0}},
                           {{"KPM", 0.0}, {"KIM", 14.9}, {"KG", 1.0}},
                           {{"KIM", 0.0}, {"KG", 0.0}, {"KPM", 1.0}},
                           {{"KIR", 0.0}, {"TA", 0.0}, {"TR", 0.0}}}) {
    const Values v = esst4b_with(more);
    for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
      ControlBench bench("ESST4B", v);
      ASSERT_TRUE(bench.problems.empty());
      ASSERT_EQ(bench.refused, "");
      EXPECT_LT(bench.largest_derivative(), 1e-12);  // rounding divided by TA
      EXPECT_NEAR(bench.out().Efd, 2.0, 1e-14);
      const C s(0.0, omega);
      const double VB = source(bench.in);
      const C inner = v.at("KPM") + v.at("KIM") / s;
      const C exact = (v.at("KPR") + v.at("KIR") / s) * lead_over_lag(0.0, v.at("TA"), omega) * VB * inner /
                      (1.0 + v.at("KG") * VB * inner);
      // difference quotients with step 1e-6, times gains of up to 15 x 60
      EXPECT_LT(std::abs(bench.response(&Signals<double>::Vs, kEsst4bEfd, omega) - exact),
                1e-7 * (1.0 + std::abs(exact)));
      EXPECT_LT(std::abs(bench.response(&Signals<double>::Vc, kEsst4bEfd, omega) +
                         exact * lead_over_lag(0.0, v.at("TR"), omega)),
                1e-7 * (1.0 + std::abs(exact)));
    }
  }
}

TEST(ExciterEsst4b, CeilingIsVmmaxTimesTheSource) {
  ControlBench bench("ESST4B", esst4b_with({{"VMMAX", 0.8}, {"VMMIN", -0.5}}));
  bench.in.dVref = 0.5;
  bench.run(20.0);
  EXPECT_NEAR(bench.out().Efd, 0.8 * source(bench.in), 1e-14);
  bench.in.Vr = 0.5;  // the source follows V and I without delay
  bench.in.Vi = 0.1;
  bench.in.Ii = -0.6;
  bench.in.Ifd = 3.0;
  EXPECT_NEAR(bench.out().Efd, 0.8 * source(bench.in), 1e-14);
  bench.in.dVref = -0.5;
  bench.run(20.0);
  EXPECT_NEAR(bench.out().Efd, -0.5 * source(bench.in), 1e-14);
}

TEST(ExciterEsst4b, SourceIsLimitedByVbmax) {
  ControlBench bench("ESST4B", esst4b_with({{"VMMAX", 0.8}, {"VBMAX", 4.0}}));
  EXPECT_GT(source(bench.in), 4.0);
  bench.in.dVref = 0.5;
  bench.run(20.0);
  EXPECT_NEAR(bench.out().Efd, 0.8 * 4.0, 1e-14);
}

TEST(ExciterEsst4b, RegulatorsDoNotWindUpAndReleaseWithoutDelay) {
  ControlBench bench("ESST4B", esst4b_with({{"VRMAX", 1.5}, {"VMMAX", 0.6}, {"KG", 0.0}}));
  bench.in.dVref = 0.1;
  bench.run(30.0);
  // the output of both, not the integral, is at its limit; at most 0.002 pu beyond it
  EXPECT_GE(bench.state("xr") + 3.0 * 0.1, 1.5);
  EXPECT_LE(bench.state("xr") + 3.0 * 0.1, 1.502);
  EXPECT_NEAR(bench.state("Va"), 1.5, 1e-12);
  const double clamped = bench.state("xm");
  bench.run(1.0);
  EXPECT_NEAR(bench.state("xm"), clamped, 1e-12);  // rounding at the band's edge
  bench.in.dVref = -0.6;
  bench.run(0.2);
  EXPECT_LT(bench.state("Va"), 0.0);  // falls to 1.5 - 3 x 0.7, with TA = 0.05 s
  EXPECT_LT(bench.out().Efd, 0.6 * source(bench.in));
}

TEST(ExciterEsst4b, RefusesOperatingPointBeyondItsLimits) {
  EXPECT_NE(ControlBench("ESST4B", {{"VMMAX", 0.1}}).refused.find("Vmr = 0.2"), std::string::npos);
  EXPECT_NE(ControlBench("ESST4B", {{"VRMAX", 0.1}}).refused.find("Vr = 0.2"), std::string::npos);
  EXPECT_NE(ControlBench("ESST4B", {{"KC", 1.0}, {"KP", 1.0}}).refused.find("VB = 0.0"), std::string::npos);
  EXPECT_EQ(ControlBench("ESST4B", {{"KPR", 0.0}, {"KIR", 0.0}, {"KP", 0.0}, {"VBMAX", 0.0}, {"TA", -1.0}})
                .problems.list()
                .size(),
            4u);
}

}  // namespace
}  // namespace swingbank::sim::test
