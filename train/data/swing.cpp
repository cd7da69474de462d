#include "train/data/swing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/constants.hpp"
#include "base/problem.hpp"
#include "train/data/channels.hpp"

namespace swingbank::train::data {
namespace {

using Eigen::Index, Eigen::VectorXd;

constexpr double kTaper = 0.3;             ///< duration of the taper at each end [s]
constexpr double kHighestFrequency = 4.0;  ///< highest frequency of the test functions [Hz]
/// The clearing of a fault is detected by a voltage change between two samples above kVoltageStep [pu] and
/// above kNoiseSteps times the noise level.
constexpr double kVoltageStep = 0.03, kNoiseSteps = 9;
/// Number of samples after a voltage step that the integrals omit, because the step occurs within a sampling
/// interval.
constexpr std::size_t kAfterStep = 2;
constexpr double kVoltageFloor = 0.1;  ///< lower limit of V as a divisor: noise dominates below it [pu]

/// Value, first and second derivative of a function of time.
using Derivatives = std::array<double, 3>;

/// Returns a smooth step from 0 at x = 0 to 1 at x = 1, with continuous second derivative.
Derivatives rise(double x) {
  const double z = std::clamp(x, 0.0, 1.0);
  return {z * z * z * (10 - 15 * z + 6 * z * z), 30 * z * z * (1 - z) * (1 - z),
          60 * z * (1 - z) * (1 - 2 * z)};
}
Derivatives product(const Derivatives& a, const Derivatives& b) {
  return {a[0] * b[0], a[1] * b[0] + a[0] * b[1], a[2] * b[0] + 2 * a[1] * b[1] + a[0] * b[2]};
}
Derivatives taper(double t, double length) {
  Derivatives up = rise(t / kTaper), down = rise((length - t) / kTaper);
  up = {up[0], up[1] / kTaper, up[2] / (kTaper * kTaper)};
  down = {down[0], -down[1] / kTaper, down[2] / (kTaper * kTaper)};
  return product(up, down);
}
Derivatives wave(double t, double frequency, bool sine) {
  const double o = constants::turn * frequency, c = std::cos(o * t), s = std::sin(o * t);
  return sine ? Derivatives{s, o * c, -o * o * s} : Derivatives{c, -o * s, -o * o * c};
}

}  // namespace

SwingIntegrals::SwingIntegrals(const std::vector<std::string>& names, const SwingWindow& window)
    : window_(window),
      P_(channel_index(names, "P")),
      Q_(channel_index(names, "Q")),
      V_(channel_index(names, "V")),
      speed_(channel_index(names, "speed")),
      frequency_(channel_index(names, "frequency")) {
  Problems problems;
  require_channels(names, {"P", "Q", "V", "speed", "frequency"}, "the swing equation needs it", problems);
  const auto sample = [&](double t) { return static_cast<std::size_t>(std::lround(t * window.rate)); };
  event_ = sample(window.event_s);
  start_ = sample(window.start_s);
  const std::size_t end = sample(window.end_s);
  const double step = 1 / window.rate;
  const Index count = static_cast<Index>(end) - static_cast<Index>(start_ + kAfterStep + 1);
  const double length = static_cast<double>(count - 1) * step;
  if (event_ < kAfterStep + 1 || start_ < event_ || !(length > 2 * kTaper))
    problems.add(fmt::format("window {} s to {} s with an event at {} s", window.start_s, window.end_s,
                             window.event_s),
                 "start_s, end_s", "the window must start after the event and be longer than two tapers",
                 "start at the latest end of the faults");
  problems.raise();
  steady_ = event_ - kAfterStep;
  const auto waves = static_cast<Index>(std::ceil(kHighestFrequency * length));
  value_.resize(count, 2 * waves - 1);
  derivative_ = curvature_ = value_;
  for (Index k = 0; k < value_.cols(); ++k) {
    const double frequency = static_cast<double>((k + 1) / 2) / length;
    for (Index i = 0; i < count; ++i) {
      const double t = static_cast<double>(i) * step;
      const Derivatives f = product(taper(t, length), wave(t, frequency, k > 0 && k % 2 == 0));
      value_(i, k) = f[0];
      derivative_(i, k) = f[1];
      curvature_(i, k) = f[2];
    }
    const double unit = step / std::sqrt(step * value_.col(k).squaredNorm());
    for (auto* part : {&value_, &derivative_, &curvature_}) part->col(k) *= unit;
  }
}

std::size_t SwingIntegrals::samples() const {
  return start_ + kAfterStep + 1 + static_cast<std::size_t>(value_.rows());
}

std::size_t SwingIntegrals::first_sample(const float* V, double level) const {
  const double step = std::max(kVoltageStep, kNoiseSteps * level);
  for (std::size_t k = start_; k > event_; --k)
    if (std::abs(V[k] - V[k - 1]) > step) return k + kAfterStep;
  return start_;
}

void SwingIntegrals::apply(const float* record, std::size_t stride, double level, double reactance,
                           float* out) const {
  const auto channel = [&](int c) { return record + static_cast<std::size_t>(c) * stride; };
  const float *P = channel(P_), *Q = channel(Q_), *V = channel(V_), *w = channel(speed_),
              *f = channel(frequency_);
  const std::vector<double> frequency(f, f + samples());
  std::vector<double> theta(samples());
  sim::terminal_angle(frequency.data(), samples(), window_.rate, window_.system_frequency,
                      window_.frequency_filter, theta.data());
  double P0 = 0;
  for (std::size_t k = 0; k < steady_; ++k) P0 += P[k];
  P0 /= static_cast<double>(steady_);
  const std::size_t first = first_sample(V, level);
  const Index count = value_.rows();
  VectorXd missing(count), speed_deviation(count), delta(count);
  for (Index i = 0; i < count; ++i) {
    const std::size_t k = first + static_cast<std::size_t>(i);
    const double voltage = std::max(static_cast<double>(V[k]), kVoltageFloor);
    missing[i] = P0 - P[k];
    speed_deviation[i] = w[k];
    delta[i] = theta[k] + std::atan2(reactance * P[k] / voltage, voltage + reactance * Q[k] / voltage);
  }
  // The mean affects rounding errors only, because derivatives of test functions integrate to zero.
  delta.array() -= delta.mean();
  const double per_angle = -1 / (constants::turn * window_.system_frequency);
  const auto write = [&](Term term, const VectorXd& integrals) {
    Eigen::Map<Eigen::VectorXf>(out + static_cast<std::size_t>(term) * functions(), value_.cols()) =
        integrals.cast<float>();
  };
  write(power, value_.transpose() * missing);
  write(speed, value_.transpose() * speed_deviation);
  write(speed_derivative, derivative_.transpose() * speed_deviation);
  write(angle, per_angle * (derivative_.transpose() * delta));
  write(one, value_.colwise().sum().transpose());
  write(angle_derivative, per_angle * (curvature_.transpose() * delta));
}

}  // namespace swingbank::train::data
