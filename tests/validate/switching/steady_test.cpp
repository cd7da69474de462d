// Sample at which a signal leaves its level, end of the steady state, and steps of the voltage.
#include "validate/switching/steady.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "validate/switching/voltage_steps.hpp"

namespace swingbank::validate::switching {
namespace {

TEST(Leaves, IgnoresSingleSample) {
  const std::vector<double> signal = {1, 1, 1.5, 1, 0.4, 0.4, 1};
  EXPECT_EQ(leaves(signal, {.level = 1, .reach = 0.3}), 4U);
  EXPECT_EQ(leaves(signal, {.level = 1, .reach = 0.3, .in_a_row = 1}), 2U);
  EXPECT_EQ(leaves(signal, {.level = 1, .reach = 0.3, .from = 3, .in_a_row = 1}), 4U);
}
TEST(Leaves, ReturnsTheLengthWithoutADeparture) {
  const std::vector<double> signal = {1, 1, 1.25, 1.25};
  EXPECT_EQ(leaves(signal, {.level = 1, .reach = 0.25}),
            4U);  // a deviation equal to the reach does not count
  EXPECT_EQ(leaves(signal, {.level = 1, .reach = 0.2, .from = 3}), 4U);  // only one sample remains
  EXPECT_EQ(leaves({}, {.level = 1}), 0U);
}
/// 1.5 s at 50/s with noise; P and Q step after sample `at`, or swing.
record::Record powers(std::size_t at, double step, double swing = 0) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0, 1e-3);
  record::Record r;
  for (std::size_t k = 0; k < 75; ++k) {
    const double moved = (k > at ? step : 0.0) + swing * std::sin(0.2 * static_cast<double>(k));
    r.t.push_back(static_cast<double>(k) / 50);
    r.P.push_back(0.8 + 0.8 * moved + noise(random));
    r.Q.push_back(0.1 - 0.6 * moved + noise(random));
  }
  return r;
}
TEST(PowerStep, IsFoundAboveTheNoise) {
  for (const std::size_t at : {std::size_t{4}, std::size_t{9}, std::size_t{40}})
    EXPECT_EQ(before_power_step(powers(at, 0.012), 75), at);
  EXPECT_EQ(before_power_step(powers(9, 0.012), 60), 9U);
  EXPECT_EQ(before_power_step(powers(40, 0.012), 30), 29U);  // the step is after the given sample
}
TEST(PowerStep, IgnoresNoiseAndSwings) {
  EXPECT_EQ(before_power_step(powers(0, 0), 75), 74U);
  EXPECT_EQ(before_power_step(powers(0, 0, 0.05), 75), 74U);
  EXPECT_EQ(before_power_step({}, 2), 1U);  // a component's record may lack P
}
TEST(PowerStep, IgnoresOneQuantisationStep) {
  record::Record r = powers(0, 0);
  for (std::size_t k = 0; k < r.P.size(); ++k) r.P[k] = k > 30 ? 0.81 : 0.80, r.Q[k] = 0.1;
  EXPECT_EQ(before_power_step(r, 75), 74U);
}
TEST(VoltageSteps, AreDifferencesOfThePhasor) {
  record::Record r;
  r.t = {0, 0.1, 0.2};
  r.V = {1, 1, 2};
  r.theta = {0, std::numbers::pi / 2, std::numbers::pi / 2};
  const auto steps = voltage_steps(r);
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_NEAR(std::abs(steps[0] - Complex(-1, 1)), 0, 1e-15);
  EXPECT_NEAR(std::abs(steps[1] - Complex(0, 1)), 0, 1e-15);
}

}  // namespace
}  // namespace swingbank::validate::switching
