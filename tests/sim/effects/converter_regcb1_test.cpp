// REGCB1 against hand calculations: commanded current in steady state, voltage step across the reactance,
// limits, rates, refusals.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "tests/sim/effects/converter_bench.hpp"

namespace swingbank::sim {
namespace {

struct Behind : BehindImpedance {
  explicit Behind(const Changes& changes) : BehindImpedance("REGCB1", changes) {}
  std::complex<double> current(std::complex<double> v) { return BehindImpedance::current(v, v); }
};

TEST(ConverterRegcb1, StartsAtItsCommands) {
  for (const double rate_flag : {0.0, 1.0}) {
    Behind b({{"rateFlag", rate_flag}, {"Re", 0.02}});
    ASSERT_TRUE(b.problems.empty());
    ASSERT_EQ(b.refused, "");
    for (const double d : b.derivatives(1.0)) EXPECT_NEAR(d, 0.0, 1e-12);
    expect_near(b.current(std::polar(1.0, 0.7)), {0.6, 0.2}, 1e-14);  // rotates with the voltage
  }
}

TEST(ConverterRegcb1, VoltageDropDrivesCurrentThroughTheReactance) {
  Behind b({});
  // terminal voltage 0.05 pu lower at an inner voltage of 1 pu: 0.05/0.25 pu more reactive current, without
  // delay
  expect_near(b.current(0.95), {0.6, 0.2 + 0.2}, 1e-13);
  EXPECT_NEAR(b.derivatives(0.95)[3], (0.95 + 0.25 * 0.2 - b.x[3]) / 0.01, 1e-10);
  Behind resistive({{"Re", 0.25}, {"Xe", 1e-9}});
  expect_near(resistive.current(0.95), {0.6 + 0.2, 0.2}, 1e-7);
  Behind at_once({{"Te", 0.0}});
  expect_near(at_once.current(0.95), {0.6, 0.2}, 1e-13);
}

TEST(ConverterRegcb1, AerodynamicPowerStaysConstantInAFault) {
  Behind b({});
  b.derivatives(0.1);
  EXPECT_DOUBLE_EQ(b.s.Paero, 0.6);
}

TEST(ConverterRegcb1, PriorityCurrentIsLimitedLast) {
  Behind q_leads({{"Imax", 1.0}}), p_leads({{"Imax", 1.0}, {"pqFlag", 1.0}});
  expect_near(q_leads.current(0.85), {0.6, 0.8}, 1e-13);  // 0.15/0.25 pu more: just Imax
  expect_near(q_leads.current(0.825), {std::sqrt(1 - 0.81), 0.9}, 1e-13);
  expect_near(p_leads.current(0.7), {0.6, 0.8}, 1e-13);
  // When the reactive current, which has priority, is at Imax, 0.025 Imax remain for the active current.
  expect_near(q_leads.current(0.5), {0.025, 1.0}, 1e-13);
}

TEST(ConverterRegcb1, RatesAndRefusals) {
  Behind b({{"rrpwr", 0.5}, {"Iqrmax", 3.0}});
  b.s.Tm = 0.9, b.s.Efd = 0.9;
  auto dx = b.derivatives(1.0);
  EXPECT_NEAR(dx[0], 0.5, 1e-14);
  EXPECT_NEAR(dx[1], 3.0, 1e-14);
  b.s.Tm = 0.1, b.s.Efd = 0.1;  // no lower rate limit: Q0 > 0
  dx = b.derivatives(1.0);
  EXPECT_NEAR(dx[0], (0.1 - 0.6) / 0.02, 1e-11);
  EXPECT_NEAR(dx[1], (0.1 - 0.2) / 0.02, 1e-11);
  EXPECT_NE(Behind({{"Imax", 0.5}}).refused.find("Imax"), std::string::npos);
  EXPECT_EQ(Behind({{"Xe", 0.0}, {"Tg", 0.0}, {"pqFlag", 2.0}, {"Te", -1.0}}).problems.list().size(), 4u);
}

}  // namespace
}  // namespace swingbank::sim
