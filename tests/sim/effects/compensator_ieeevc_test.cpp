// IEEEVC: the regulated voltage by complex arithmetic, droop and line-drop compensation, no effect at zero.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

TEST(CompensatorIeeevc, IsTheVoltageBehindTheImpedance) {
  Signals<double> at = ControlBench::rated();
  at.Vr = 0.98;
  at.Vi = 0.2;
  at.V = std::abs(std::complex<double>(0.98, 0.2));
  at.Ir = 0.7;
  at.Ii = -0.3;
  for (const double r : {0.0, 0.02})
    for (const double x : {-0.08, 0.05}) {
      const auto exact = std::abs(std::complex<double>(at.Vr, at.Vi) +
                                  std::complex<double>(r, x) * std::complex<double>(at.Ir, at.Ii));
      EXPECT_DOUBLE_EQ(ControlBench("IEEEVC", {{"RC", r}, {"XC", x}}, at).out().Vc, exact);
    }
  EXPECT_DOUBLE_EQ(ControlBench("IEEEVC", {{"XC", 0.0}}, at).out().Vc, at.V);
}

TEST(CompensatorIeeevc, PositiveReactanceIsDroop) {
  Signals<double> at = ControlBench::rated();  // V = 1
  at.Ir = 0.0;
  at.Ii = -0.4;  // delivers 0.4 pu of reactive power
  EXPECT_DOUBLE_EQ(ControlBench("IEEEVC", {{"XC", 0.05}}, at).out().Vc, 1.02);
}

TEST(CompensatorIeeevc, RefusesParametersOnAnotherBase) {
  EXPECT_EQ(ControlBench("IEEEVC", {{"RC", 3.0}, {"XC", -2.0}}).problems.list().size(), 2u);
}

}  // namespace
}  // namespace swingbank::sim::test
