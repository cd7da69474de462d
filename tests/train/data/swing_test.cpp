// The weak form of the swing equation on a machine whose speed and power are known functions of time.
#include "train/data/swing.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/constants.hpp"
#include "base/problem.hpp"

namespace swingbank::train::data {
namespace {

constexpr double kH = 4.2, kD = 1.7, kX = 0.3, kSwingRate = 120, kSwingEvent = 2.0;
constexpr std::size_t kSwingSamples = 1800;
const std::vector<std::string> kSwingNames = {"P", "Q", "V", "speed", "frequency"};
const SwingWindow kWindow = {kSwingRate, kSwingEvent, 2.2, 14.5, 60.0, {}};

double speed_at(double t) {
  const double s = std::max(0.0, t - kSwingEvent);
  return 0.004 * (std::exp(-0.2 * s) * std::sin(5 * s) + 0.3 * std::sin(1.3 * s));
}

/// A record whose signals satisfy the swing equation.
std::vector<float> swing_record() {
  std::vector<float> r(kSwingNames.size() * kSwingSamples);
  std::vector<double> theta(kSwingSamples), frequency(kSwingSamples);
  double delta = 0;
  for (std::size_t k = 0; k < kSwingSamples; ++k) {
    const double t = static_cast<double>(k) / kSwingRate, h = 1e-5;
    constexpr int kParts = 20;  // integration steps of the angle per sampling interval
    for (int part = 0; k > 0 && part < kParts; ++part)
      delta +=
          constants::turn * 60 * speed_at(t - (part + 0.5) / (kSwingRate * kParts)) / (kSwingRate * kParts);
    const double derivative = t < kSwingEvent ? 0 : (speed_at(t + h) - speed_at(t - h)) / (2 * h);
    const double P = 0.8 - 2 * kH * derivative - kD * speed_at(t), Q = 0.2, V = 1.0;
    theta[k] = delta - std::atan2(kX * P / V, V + kX * Q / V);
    const double of[] = {P, Q, V, speed_at(t)};
    for (std::size_t c = 0; c < 4; ++c) r[c * kSwingSamples + k] = static_cast<float>(of[c]);
  }
  sim::terminal_frequency(theta.data(), kSwingSamples, kSwingRate, 60, {}, frequency.data());
  for (std::size_t k = 0; k < kSwingSamples; ++k) r[4 * kSwingSamples + k] = static_cast<float>(frequency[k]);
  return r;
}

class Swing : public testing::Test {
 protected:
  SwingIntegrals swing_{kSwingNames, kWindow};
  [[nodiscard]] std::vector<float> integrals(const std::vector<float>& r, double X = kX) const {
    std::vector<float> out(SwingIntegrals::terms * swing_.functions());
    swing_.apply(r.data(), kSwingSamples, 0, X, out.data());
    return out;
  }
  /// Largest residual of the equation over the test functions, relative to the largest power term.
  [[nodiscard]] double residual(const std::vector<float>& out, SwingIntegrals::Term speed,
                                SwingIntegrals::Term derivative) const {
    const std::size_t n = swing_.functions();
    double largest = 0, power = 0;
    for (std::size_t k = 0; k < n; ++k) {
      power = std::max(power, std::abs(static_cast<double>(out[SwingIntegrals::power * n + k])));
      largest = std::max(largest, std::abs(-2 * kH * out[derivative * n + k] + kD * out[speed * n + k] -
                                           out[SwingIntegrals::power * n + k]));
    }
    return largest / power;
  }
};

TEST_F(Swing, EquationHoldsWithSpeedAndWithAngle) {
  const auto out = integrals(swing_record());
  EXPECT_LT(residual(out, SwingIntegrals::speed, SwingIntegrals::speed_derivative), 1e-5);
  EXPECT_LT(residual(out, SwingIntegrals::angle, SwingIntegrals::angle_derivative), 1e-3);
  EXPECT_GT(
      residual(integrals(swing_record(), 2 * kX), SwingIntegrals::angle, SwingIntegrals::angle_derivative),
      1e-2);
}
TEST_F(Swing, BeginsAfterTheLastVoltageStep) {
  auto r = swing_record();
  const auto before = integrals(r);
  float* P = r.data();
  float* V = r.data() + 2 * kSwingSamples;
  const std::size_t cleared = 250;  // fault from sample 240 to 249
  for (std::size_t k = 240; k < cleared; ++k) V[k] = 0.4f;
  const auto with_fault = integrals(r);
  EXPECT_NE(with_fault, before);  // the window moves
  for (std::size_t k = 240; k <= cleared; ++k) P[k] = 0;
  EXPECT_EQ(integrals(r), with_fault);  // and excludes the fault
}
TEST_F(Swing, NamesMissingChannelsAndShortWindows) {
  EXPECT_THROW(SwingIntegrals({"P", "Q", "V"}, kWindow), InputError);
  SwingWindow brief = kWindow;
  brief.end_s = 2.7;
  EXPECT_THROW(SwingIntegrals(kSwingNames, brief), InputError);
  brief = kWindow;
  brief.start_s = 1.0;
  EXPECT_THROW(SwingIntegrals(kSwingNames, brief), InputError);
}

}  // namespace
}  // namespace swingbank::train::data
