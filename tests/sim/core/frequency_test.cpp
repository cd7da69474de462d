#include "sim/core/frequency.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

namespace swingbank::sim {
namespace {

constexpr double kRate = 120.0, kF0 = 60.0;
const FrequencyFilter kConstants{0.1, 0.02};

std::vector<double> frequency_of(const std::vector<double>& theta) {
  std::vector<double> out(theta.size());
  terminal_frequency(theta.data(), theta.size(), kRate, kF0, kConstants, out.data());
  return out;
}

TEST(TerminalFrequency, SteadyRampGivesItsSlope) {
  const double deviation = 0.01;  // pu: theta grows by 2 pi 60 0.01 rad/s and wraps several times
  std::vector<double> theta;
  for (int k = 0; k < 600; ++k) theta.push_back(2 * std::numbers::pi * kF0 * deviation * k / kRate);
  // After 5 s the slower filter has settled to exp(-50); only rounding of the angles remains.
  EXPECT_NEAR(frequency_of(theta).back(), deviation, 1e-10);
}

TEST(TerminalFrequency, WrappedAnglesGiveTheSameResult) {
  std::vector<double> straight, wrapped;
  for (int k = 0; k < 600; ++k) {
    straight.push_back(0.5 + 4.0 * k / kRate);
    wrapped.push_back(std::remainder(straight.back(), 2 * std::numbers::pi));
  }
  const auto a = frequency_of(straight), b = frequency_of(wrapped);
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-12);  // rounding of remainder()
}

TEST(TerminalFrequency, RampFollowsTheAnalyticResponse) {
  std::vector<double> theta;
  for (int k = 0; k < 120; ++k) theta.push_back(k / kRate);  // 1 rad/s
  const auto f = frequency_of(theta);
  const double Tw = kConstants.washout, Tf = kConstants.filter;
  for (int k = 0; k < 120; ++k) {
    const double t = k / kRate;
    // Step response of 1/((1 + s Tw)(1 + s Tf)).
    const double expected =
        (1.0 - (Tw * std::exp(-t / Tw) - Tf * std::exp(-t / Tf)) / (Tw - Tf)) / (2 * std::numbers::pi * kF0);
    EXPECT_NEAR(f[static_cast<std::size_t>(k)], expected, 1e-14);  // exact for a ramp, up to rounding
  }
}

TEST(TerminalFrequency, IntegralReturnsTheAngle) {
  std::vector<double> theta;
  for (int k = 0; k < 1800; ++k)  // steps and oscillation
    theta.push_back(0.3 + (k > 240 ? -0.4 : 0.0) + 0.8 * std::sin(0.02 * k) + (k == 900 ? 1.0 : 0.0));
  const auto f = frequency_of(theta);
  std::vector<double> back(theta.size());
  terminal_angle(f.data(), f.size(), kRate, kF0, kConstants, back.data());
  for (std::size_t k = 0; k < theta.size(); ++k) EXPECT_NEAR(back[k], theta[k] - theta[0], 1e-11) << k;
}

TEST(TerminalFrequency, ConstantAngleGivesZero) {
  for (double v : frequency_of(std::vector<double>(50, -2.5))) EXPECT_EQ(v, 0.0);
}

}  // namespace
}  // namespace swingbank::sim
