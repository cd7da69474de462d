// Converter controls against hand calculations: current limits, behaviour during and after a voltage dip,
// dead-bands, freezing, torsion of the shaft.
#include <cmath>
#include <numbers>

#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim {
namespace {

using test::ControlBench;

/// A converter at rated voltage: 0.8 pu of active and `reactive` pu of reactive current.
Signals<double> at_rated(double reactive = 0.0) {
  Signals<double> s;
  s.Vr = s.V = s.Vc = s.Vpr = s.Vp = 1.0;
  s.Ir = s.P = s.Tm = s.Pneed = s.Paero = s.Pord = 0.8;
  s.Ii = -reactive;
  s.Q = s.Efd = s.Qneed = reactive;
  return s;
}

TEST(Reecb1, QPriorityLimitsTheActiveCurrent) {
  ControlBench bench("REECB1", {{"Imax", 1.0}, {"Kqv", 2.0}, {"dbd1", -0.05}, {"dbd2", 0.05}}, at_rated());
  EXPECT_TRUE(bench.problems.empty());
  EXPECT_EQ(bench.refused, "");
  EXPECT_LT(bench.largest_derivative(), 1e-12);
  bench.in.V = 0.5;
  bench.run(1.0);
  const double Iq = 2.0 * (1.0 - 0.5 - 0.05);
  EXPECT_NEAR(bench.out().Efd, Iq, 1e-9);
  EXPECT_NEAR(bench.out().Tm, std::sqrt(1.0 - Iq * Iq), 1e-9);  // demand: 0.8/0.5
}
TEST(Reecb1, PPriorityLimitsTheReactiveCurrent) {
  ControlBench bench("REECB1", {{"Imax", 1.0}, {"Kqv", 2.0}, {"PQFLAG", 1.0}}, at_rated());
  bench.in.V = 0.9;
  bench.run(1.0);
  const double Ip = 0.8 / 0.9;
  EXPECT_NEAR(bench.out().Tm, Ip, 1e-9);
  EXPECT_NEAR(bench.out().Efd, std::min(0.2, std::sqrt(1.0 - Ip * Ip)), 1e-9);
}
TEST(Reecb1, VoltageDipFreezesTheOrderedPower) {
  ControlBench bench("REECB1", {{"Vdip", 0.9}}, at_rated());
  bench.in.V = 0.8;
  bench.in.Pext = -0.3;
  bench.run(1.0);
  EXPECT_NEAR(bench.state("Pord"), 0.8, 1e-12);
  bench.in.V = 1.0;
  bench.run(1.0);
  EXPECT_NEAR(bench.state("Pord"), 0.5, 1e-9);
}
TEST(Reecb1, RefusesOperatingPointBeyondItsCurrentLimit) {
  EXPECT_NE(ControlBench("REECB1", {{"Imax", 0.7}}, at_rated()).refused, "");
  EXPECT_EQ(ControlBench("REECB1", {{"VFLAG", 2.0}}, at_rated()).problems.list().size(), 1u);
}

TEST(Reeca1, InjectsDuringAndAfterAVoltageDip) {
  ControlBench bench("REECA1", {{"Vdip", 0.85}, {"Vup", 1.2}, {"Kqv", 2.0}, {"Thld", -0.5}, {"Trv", 0.0}},
                     at_rated());
  EXPECT_EQ(bench.refused, "");
  bench.in.V = 0.9;  // no dip: nothing is injected
  bench.run(0.1);
  EXPECT_NEAR(bench.out().Efd, 0.0, 1e-12);
  bench.in.V = 0.7;
  bench.run(0.1);
  EXPECT_NEAR(bench.out().Efd, 2.0 * 0.3, 1e-9);
  bench.in.V = 0.9;
  bench.run(0.45);
  EXPECT_NEAR(bench.out().Efd, 2.0 * 0.1, 1e-9);
  bench.run(0.1);
  EXPECT_NEAR(bench.out().Efd, 0.0, 1e-12);
}
TEST(Reeca1, KeepsIqfrzAfterAVoltageDip) {
  ControlBench bench("REECA1", {{"Vdip", 0.85}, {"Kqv", 2.0}, {"Thld", 0.5}, {"Iqfrz", 0.15}, {"Trv", 0.0}},
                     at_rated());
  bench.in.V = 0.7;
  bench.run(0.1);
  bench.in.V = 1.0;
  bench.run(0.4);
  EXPECT_NEAR(bench.out().Efd, 0.15, 1e-9);
  bench.run(0.2);
  EXPECT_NEAR(bench.out().Efd, 0.0, 1e-12);
}
TEST(Reeca1, LimitsFollowTheirPoints) {
  ControlBench bench("REECA1",
                     {{"Trv", 0.0},
                      {"Vp1", 0.2},
                      {"Ip1", 0.1},
                      {"Vp2", 0.6},
                      {"Ip2", 0.5},
                      {"Vp3", 1.0},
                      {"Ip3", 1.0},
                      {"Vp4", 1.2},
                      {"Ip4", 1.0}},
                     at_rated());
  EXPECT_EQ(bench.refused, "");
  bench.in.V = 0.4;
  EXPECT_NEAR(bench.out().Tm, 0.3, 1e-12);
  bench.in.V = 0.7;
  EXPECT_NEAR(bench.out().Tm, 0.5 + 0.5 * 0.25, 1e-12);
}

TEST(Repca1, RegulatesOutsideItsDeadBandAndFreezes) {
  ControlBench bench("REPCA1",
                     {{"RefFlag", 1.0},
                      {"Kc", 0.0},
                      {"Kp", 0.0},
                      {"Ki", 5.0},
                      {"dbd1", -0.01},
                      {"dbd2", 0.01},
                      {"Vfrz", 0.7}},
                     at_rated(0.1));
  EXPECT_EQ(bench.refused, "");
  EXPECT_LT(bench.largest_derivative(), 1e-12);
  bench.in.V = 0.992;
  bench.run(1.0);
  EXPECT_NEAR(bench.state("integral"), 0.1, 1e-12);
  bench.in.V = 0.97;
  bench.run(0.5);
  bench.in.V = 1.0;  // the measurement recovers with the filter's 0.02 s
  EXPECT_NEAR(bench.state("integral"), 0.1 + 5.0 * 0.02 * 0.5, 3e-3);
  bench.in.V = 0.6;
  const double before = bench.state("integral");
  bench.run(1.0);
  EXPECT_NEAR(bench.state("integral"), before, 1e-12);
}
TEST(Repca1, DroopsWithTheFrequency) {
  ControlBench bench("REPCA1", {{"Ddn", 20.0}, {"fdbd1", -0.001}, {"Kig", 0.0}}, at_rated());
  bench.in.speed = 0.005;
  bench.run(2.0);
  EXPECT_NEAR(bench.out().Pext, -20.0 * 0.004, 1e-6);
  bench.in.speed = -0.005;  // Dup = 0
  bench.run(2.0);
  EXPECT_NEAR(bench.out().Pext, 0.0, 1e-6);
}

TEST(Wtdta1, TorsionalModeOscillatesAtFreq1) {
  ControlBench bench("WTDTA1", {{"Freq1", 2.0}, {"Dshaft", 0.0}, {"Htfrac", 0.8}}, at_rated());
  EXPECT_LT(bench.largest_derivative(), 1e-12);
  const double rest = bench.state("twist");
  bench.state("twist") += 1e-3;
  bench.run(0.25, 1e-4);  // half a period
  // at constant power the torque falls with speed: the amplitude changes by some per cent
  EXPECT_NEAR(bench.state("twist"), rest - 1e-3, 1e-4);
}
TEST(Wttqa1, SpeedReferenceFollowsItsCurve) {
  auto in = at_rated();
  in.P = in.Pneed = 0.5;
  ControlBench bench("WTTQA1", {}, in);
  EXPECT_EQ(bench.refused, "");
  EXPECT_NEAR(bench.out().wref, 0.72 + 0.5 * 0.14 - 1.0, 1e-12);
  bench.in.wg = bench.out().wref;
  EXPECT_NEAR(bench.out().Pext, 0.0, 1e-12);
}

}  // namespace
}  // namespace swingbank::sim
