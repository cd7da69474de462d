// ESST3A: transfer function against the diagram, limits, release, the inner loop without a lag.
#include <numbers>

#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

using C = std::complex<double>;
using Values = ControlBench::Changes;

Values esst3a_with(Values more) {
  Values v = {{"TR", 0.02}, {"TC", 1.0},      {"TB", 5.0},  {"KA", 100.0}, {"TA", 0.05},
              {"KM", 4.0},  {"TM", 0.3},      {"KG", 0.8},  {"KP", 6.0},   {"KI", 0.4},
              {"KC", 0.1},  {"THETAP", 20.0}, {"XL", 0.08}, {"VGMAX", 5.0}};
  for (const auto& [k, x] : more) v[k] = x;
  return v;
}
/// Source voltage VB for these values by IEEE Std 421.5, from the bench's phasors V and I; FEX is in its
/// first region.
double esst3a_source(const Signals<double>& s) {
  const C V(s.Vr, s.Vi), I(s.Ir, s.Ii), kp = std::polar(6.0, 20.0 * std::numbers::pi / 180.0);
  const double ve = std::abs(kp * V + C(0.0, 1.0) * (0.4 + kp * 0.08) * I);
  return ve * (1.0 - 0.1 * s.Ifd / ve / std::sqrt(3.0));
}

TEST(ExciterEsst3a, TransferFunctionIsTheDiagrams) {
  for (const auto& more :
       {Values{}, {{"TM", 0.0}}, {{"TA", 0.0}, {"TR", 0.0}, {"TB", 0.0}, {"TC", 0.0}}, {{"KG", 0.0}}}) {
    const Values v = esst3a_with(more);
    for (const double omega : {0.1, 1.0, 7.0, 40.0}) {
      ControlBench bench("ESST3A", v);
      ASSERT_TRUE(bench.problems.empty());
      ASSERT_EQ(bench.refused, "");
      EXPECT_LT(bench.largest_derivative(), 1e-11);  // rounding times KA/TA
      EXPECT_NEAR(bench.out().Efd, 2.0, 1e-14);
      const C inner = 4.0 * esst3a_source(bench.in) * lead_over_lag(0.0, v.at("TM"), omega);
      const C exact = 100.0 * lead_over_lag(v.at("TC"), v.at("TB"), omega) *
                      lead_over_lag(0.0, v.at("TA"), omega) * inner / (1.0 + v.at("KG") * inner);
      // difference quotients with step 1e-6, amplified by gains of up to 2400
      EXPECT_LT(std::abs(bench.response(&Signals<double>::Vs, &Signals<double>::Efd, omega) - exact),
                1e-7 * (1.0 + std::abs(exact)));
      EXPECT_LT(std::abs(bench.response(&Signals<double>::Vc, &Signals<double>::Efd, omega) +
                         exact * lead_over_lag(0.0, v.at("TR"), omega)),
                1e-7 * (1.0 + std::abs(exact)));
    }
  }
}

TEST(ExciterEsst3a, CeilingIsVmmaxTimesTheSourceAndReleasesWithoutDelay) {
  ControlBench bench("ESST3A", esst3a_with({{"VMMAX", 0.6}, {"VMMIN", -0.2}, {"TB", 0.0}, {"TC", 0.0}}));
  bench.in.dVref = 0.15;
  bench.run(10.0);
  EXPECT_NEAR(bench.out().Efd, 0.6 * esst3a_source(bench.in), 1e-14);
  bench.in.Vr = 0.5;  // the source follows V and I without delay
  bench.in.Ii = -0.6;
  EXPECT_NEAR(bench.out().Efd, 0.6 * esst3a_source(bench.in), 1e-14);
  bench.in.dVref = -0.15;
  bench.run(0.3);
  EXPECT_LT(bench.out().Efd, 0.6 * esst3a_source(bench.in));
  bench.run(10.0);
  EXPECT_NEAR(bench.out().Efd, -0.2 * esst3a_source(bench.in), 1e-14);
}

TEST(ExciterEsst3a, BeyondVgmaxTheLoopIsOpen) {
  for (const double TM : {0.0, 0.3}) {
    ControlBench bench(
        "ESST3A", esst3a_with({{"VGMAX", 1.9}, {"VMMAX", 99.0}, {"VBMAX", 99.0}, {"TB", 0.0}, {"TM", TM}}));
    bench.in.dVref = 0.005;
    bench.run(10.0);
    // Vr rises by 100 x 0.005; KG Efd reaches VGMAX, and the remainder is amplified by KM
    const double VB = esst3a_source(bench.in), vr = 0.8 * 2.0 + 2.0 / VB / 4.0 + 0.5;
    const double expected = std::max(4.0 * vr / (1.0 + 4.0 * 0.8 * VB), 4.0 * (vr - 1.9)) * VB;
    EXPECT_GT(0.8 * expected, 1.9);
    EXPECT_NEAR(bench.out().Efd, expected, 1e-9);
  }
}

TEST(ExciterEsst3a, ErrorAndSourceAreLimited) {
  ControlBench bench("ESST3A",
                     esst3a_with({{"VIMAX", 0.03}, {"VBMAX", 4.0}, {"VMMAX", 99.0}, {"VGMAX", 99.0}}));
  EXPECT_GT(esst3a_source(bench.in), 4.0);
  bench.in.dVref = 1.0;
  bench.run(60.0);
  EXPECT_NEAR(bench.out().Efd, 3.0 * 4.0 * 4.0 / (1.0 + 4.0 * 0.8 * 4.0), 1e-4);  // after 60 s = 12 TB
}

TEST(ExciterEsst3a, RefusesOperatingPointBeyondItsLimits) {
  EXPECT_NE(ControlBench("ESST3A", {{"VMMAX", 0.1}}).refused.find("Vmr"), std::string::npos);
  EXPECT_NE(ControlBench("ESST3A", {{"VIMAX", 0.001}}).refused.find("VIMAX"), std::string::npos);
  EXPECT_NE(ControlBench("ESST3A", {{"KC", 1.0}, {"KP", 1.0}}).refused.find("VB = 0.0"), std::string::npos);
  EXPECT_EQ(ControlBench("ESST3A", {{"KA", 0.0}, {"KM", -1.0}, {"KP", 0.0}, {"VBMAX", 0.0}, {"TM", -1.0}})
                .problems.list()
                .size(),
            5u);
}

}  // namespace
}  // namespace swingbank::sim::test
