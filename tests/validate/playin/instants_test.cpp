// When a signal leaves its level, and how the voltage steps.
#include "validate/playin/instants.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace swingbank::validate::playin {
namespace {

TEST(Leaves, OneSampleAloneIsNoise) {
  const std::vector<double> signal = {1, 1, 1.5, 1, 0.4, 0.4, 1};
  EXPECT_EQ(leaves(signal, {.level = 1, .reach = 0.3}), 4U);
  EXPECT_EQ(leaves(signal, {.level = 1, .reach = 0.3, .in_a_row = 1}), 2U);
  EXPECT_EQ(leaves(signal, {.level = 1, .reach = 0.3, .from = 3, .in_a_row = 1}), 4U);
}
TEST(Leaves, WhatStaysGivesTheLength) {
  const std::vector<double> signal = {1, 1, 1.25, 1.25};
  EXPECT_EQ(leaves(signal, {.level = 1, .reach = 0.25}), 4U);  // as far off as the reach is not further
  EXPECT_EQ(leaves(signal, {.level = 1, .reach = 0.2, .from = 3}), 4U);  // one sample is left
  EXPECT_EQ(leaves({}, {.level = 1}), 0U);
}
TEST(VoltageSteps, AreOfThePhasor) {
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
}  // namespace swingbank::validate::playin
