// REGCC1 against hand calculations: commanded current in steady state, phase-locked loop at an angle step
// with its limits and freezing, current control with its limits, source behind its impedance, refusals.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "tests/sim/effects/converter_bench.hpp"

namespace swingbank::sim {
namespace {

enum X { Ip, Iq, Vf, Sp, Sq, Ed, Eq, phi, w };

/// The loop's axis is at angle 0, the angle of the voltage in steady().
struct Locked : BehindImpedance {
  explicit Locked(const Changes& changes, std::complex<double> power = {0.6, 0.2})
      : BehindImpedance("REGCC1", changes, power) {}
  std::complex<double> current(std::complex<double> v) { return BehindImpedance::current(v, 1.0); }
};

TEST(ConverterRegcc1, StartsAtItsCommands) {
  for (const double rate_flag : {0.0, 1.0})
    for (const double te : {0.0, 0.02}) {
      Locked b({{"rateFlag", rate_flag}, {"Re", 0.02}, {"Te", te}});
      ASSERT_TRUE(b.problems.empty());
      ASSERT_EQ(b.refused, "");
      for (const double d : b.derivatives(1.0)) EXPECT_NEAR(d, 0.0, 1e-12);
      expect_near(b.current(1.0), {0.6, 0.2}, 1e-14);
    }
}

TEST(ConverterRegcc1, AerodynamicPowerStaysConstantInAFault) {
  Locked b({});
  b.derivatives(0.1);
  EXPECT_DOUBLE_EQ(b.s.Paero, 0.6);
}

TEST(ConverterRegcc1, PllFollowsAnAngleStep) {
  Locked b({{"Kppll", 8.0}, {"Kipll", 600.0}});
  const double across = std::sin(0.1);
  auto dx = b.derivatives(std::polar(1.0, 0.1));
  EXPECT_NEAR(dx[phi], 8.0 * across, 1e-13);
  EXPECT_NEAR(dx[w], 600.0 * across, 1e-11);
  dx = b.derivatives(std::polar(0.5, -0.1));  // half the voltage, half the gain
  EXPECT_NEAR(dx[phi], -4.0 * across, 1e-13);
  b.x[phi] = 0.1;
  b.x[w] = 2.0;
  dx = b.derivatives(std::polar(1.0, 0.1));
  EXPECT_NEAR(dx[phi], 2.0, 1e-13);  // locked to a frequency 2 rad/s above nominal
  EXPECT_NEAR(dx[w], 0.0, 1e-11);
}
TEST(ConverterRegcc1, PllIsLimitedAndFrozenAtLowVoltage) {
  Locked b({{"Kppll", 100.0}, {"wmax", 3.0}, {"wmin", -4.0}});
  auto dx = b.derivatives(std::polar(1.0, 0.1));  // demand: 100 sin 0.1 = 9.98 rad/s
  EXPECT_EQ(dx[phi], 3.0);
  EXPECT_EQ(dx[w], 0.0);
  dx = b.derivatives(std::polar(1.0, -0.1));
  EXPECT_EQ(dx[phi], -4.0);
  EXPECT_EQ(dx[w], 0.0);
  Locked frozen({{"Kipll", 600.0}, {"Vpllfrz", 0.3}});
  frozen.x[w] = 1.0;
  dx = frozen.derivatives(std::polar(0.29, 0.1));
  EXPECT_EQ(dx[phi], 0.0);
  EXPECT_EQ(dx[w], 0.0);
  EXPECT_NEAR(frozen.derivatives(std::polar(0.301, 0.1))[w], 600.0 * 0.301 * std::sin(0.1), 1e-11);
}

TEST(ConverterRegcc1, VoltageChangeDrivesCurrentThroughTheReactance) {
  Locked b({});
  // terminal voltage 0.05 pu lower at constant inner voltage: 0.05/0.25 pu more reactive current, without
  // delay
  expect_near(b.current(0.95), {0.6, 0.2 + 0.2}, 1e-13);
  // Voltage 0.02 rad ahead of the loop: (E - V)/(j Xe) in the loop's frame.
  const std::complex<double> inner(1.0 + 0.25 * 0.2, 0.25 * 0.6), v = std::polar(1.0, 0.02);
  expect_near(b.current(v), std::conj((inner - v) / std::complex<double>(0.0, 0.25)), 1e-13);
  // after the loop has followed: the commanded current, rotated by the same angle
  b.x[phi] = 0.02;
  expect_near(b.BehindImpedance::current(v, v), {0.6, 0.2}, 1e-13);
}
TEST(ConverterRegcc1, CurrentControlMovesTheInnerVoltage) {
  Locked b({{"Kip", 2.0}, {"Kii", 30.0}, {"Re", 0.02}, {"Te", 0.01}});
  b.x[Ip] = 0.7;  // commands exceed the flowing current by 0.1 pu active and 0.05 pu reactive
  b.x[Iq] = 0.25;
  const auto dx = b.derivatives(1.0);
  EXPECT_NEAR(dx[Sp], 30.0 * 0.1, 1e-12);
  EXPECT_NEAR(dx[Sq], 30.0 * 0.05, 1e-12);
  EXPECT_NEAR(dx[Ed], (0.02 * 2.0 * 0.1 + 0.25 * 2.0 * 0.05) / 0.01, 1e-10);
  EXPECT_NEAR(dx[Eq], (0.25 * 2.0 * 0.1 - 0.02 * 2.0 * 0.05) / 0.01, 1e-10);
  // Te 0: I = Kip (Ip - I) + integral, so I = (Kip Ip + integral)/(1 + Kip), for any voltage.
  Locked at_once({{"Kip", 2.0}, {"Te", 0.0}});
  at_once.x[Ip] = 0.75;
  at_once.x[Iq] = 0.26;
  expect_near(at_once.current(0.9), {(2.0 * 0.75 + 0.6) / 3.0, (2.0 * 0.26 + 0.2) / 3.0}, 1e-14);
  expect_near(at_once.current(std::polar(0.4, 0.3)), {(2.0 * 0.75 + 0.6) / 3.0, (2.0 * 0.26 + 0.2) / 3.0},
              1e-14);
}

TEST(ConverterRegcc1, PriorityCurrentIsLimitedLast) {
  Locked q_leads({{"Imax", 1.0}}), p_leads({{"Imax", 1.0}, {"pqFlag", 1.0}});
  expect_near(q_leads.current(0.85), {0.6, 0.8}, 1e-13);  // 0.15/0.25 pu more: just Imax
  expect_near(q_leads.current(0.825), {std::sqrt(1 - 0.81), 0.9}, 1e-13);
  expect_near(p_leads.current(0.7), {0.6, 0.8}, 1e-13);
  expect_near(q_leads.current(0.5), {0.025, 1.0}, 1e-13);
}
TEST(ConverterRegcc1, IntegralsAreLimitedByImax) {
  Locked b({{"Imax", 1.0}, {"Kip", 1.0}, {"Kii", 30.0}, {"Te", 0.02}});
  b.x[Iq] = 0.9;  // 0.7 pu above the flowing current, 0.9 pu with the integral's 0.2 pu: sqrt(0.19) pu remain
  b.x[Sp] = 0.6;
  auto dx = b.derivatives(1.0);
  EXPECT_NEAR(dx[Sq], 30.0 * 0.7, 1e-11);
  const double second_limit = std::sqrt(1.0 - 0.81);
  EXPECT_NEAR(dx[Eq], 0.25 * (second_limit - 0.6) / 0.02, 1e-10);
  b.x[Ip] = 0.65;  // beyond its limit the active integral does not rise
  dx = b.derivatives(1.0);
  EXPECT_EQ(dx[Sp], 0.0);
  b.x[Ip] = 0.55;  // but may fall
  dx = b.derivatives(1.0);
  EXPECT_NEAR(dx[Sp], -30.0 * 0.05, 1e-12);
  b.x[Iq] = 1.2;  // 1.0 + 0.2 pu: the reactive current alone exceeds Imax
  dx = b.derivatives(1.0);
  EXPECT_EQ(dx[Sq], 0.0);
  EXPECT_NEAR(dx[Ed], 0.25 * (1.0 - 0.2) / 0.02, 1e-10);
}

TEST(ConverterRegcc1, RatesAndRefusals) {
  Locked b({{"rrpwr", 0.5}, {"Iqrmax", 3.0}});
  b.s.Tm = 0.9, b.s.Efd = 0.9;
  auto dx = b.derivatives(1.0);
  EXPECT_NEAR(dx[Ip], 0.5, 1e-14);
  EXPECT_NEAR(dx[Iq], 3.0, 1e-14);
  b.s.Tm = 0.1, b.s.Efd = 0.1;  // no lower rate limit: Q0 > 0
  dx = b.derivatives(1.0);
  EXPECT_NEAR(dx[Ip], (0.1 - 0.6) / 0.02, 1e-11);
  EXPECT_NEAR(dx[Iq], (0.1 - 0.2) / 0.02, 1e-11);
  EXPECT_NE(Locked({{"Imax", 0.5}}).refused.find("Imax"), std::string::npos);
  EXPECT_EQ(
      Locked({{"Xe", 0.0}, {"Kip", -1.0}, {"Kipll", -1.0}, {"wmax", -1.0}, {"wmin", 1.0}, {"Vpllfrz", -0.1}})
          .problems.list()
          .size(),
      6u);
}

}  // namespace
}  // namespace swingbank::sim
