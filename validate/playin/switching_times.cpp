#include "validate/playin/switching_times.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>

#include "base/white_noise.hpp"

namespace swingbank::validate::playin {
namespace {

/// Returns the smaller distance of each step from the extrapolations of the two steps before and of the two
/// after it [pu]. A switching step differs from both, the change next to it from one, a rotor swing from
/// none.
std::vector<double> extrapolation_errors(const std::vector<Complex>& step) {
  std::vector<double> out(step.size(), 0.0);
  for (std::size_t k = 2; k + 2 < step.size(); ++k)
    out[k] = std::min(std::abs(step[k] - 2.0 * step[k - 1] + step[k - 2]),
                      std::abs(step[k] - 2.0 * step[k + 1] + step[k + 2]));
  return out;
}

/// Number of values on either side of a step that determine its height.
constexpr std::size_t kSamplesBeside = 3;

double mean(std::span<const double> x) {
  return Eigen::Map<const Eigen::ArrayXd>(x.data(), static_cast<Eigen::Index>(x.size())).mean();
}
/// Returns the change from the values up to sample k to those after it.
double height(std::span<const double> x, std::size_t k) {
  return mean(x.subspan(k + 1, kSamplesBeside)) - mean(x.subspan(k + 1 - kSamplesBeside, kSamplesBeside));
}
/// Returns the variance of a height from the noise on either side, including the record's rounding.
double height_variance(std::span<const double> x, std::size_t k) {
  const auto before = x.first(k + 1), after = x.subspan(k + 1);
  const auto weight = [](std::span<const double> part) { return static_cast<double>(part.size() - 2); };
  const double noise = (weight(before) * white_variance(before) + weight(after) * white_variance(after)) /
                       (weight(before) + weight(after));
  const double step = record::quantum({x.begin(), x.end()});
  return 2.0 / kSamplesBeside * (noise + step * step / 12);
}

}  // namespace

std::size_t before_power_step(const record::Record& record, std::size_t n) {
  constexpr double kErrorsOfHeight = 6, kOfBefore = 3, kOfPower = 1e-3;
  constexpr std::size_t kSamplesBefore = 4,
                        kReaches =
                            kSamplesBeside - 1;  // samples beside a step that contain part of its height
  if (record.P.size() < n || record.Q.size() < n || n < kSamplesBefore + 2 * kSamplesBeside + 1) return n - 1;
  const std::span P(record.P.data(), n), Q(record.Q.data(), n);
  const double least = kOfPower * std::hypot(mean(P), mean(Q));
  std::vector<double> step_height(n, 0.0);
  for (std::size_t k = kReaches; k + kSamplesBeside < n; ++k)
    step_height[k] = std::hypot(height(P, k), height(Q, k));
  for (std::size_t k = kSamplesBefore; k + kSamplesBeside < n; ++k) {
    const auto beside = std::span(step_height).subspan(k - kReaches, 2 * kReaches + 1);
    const auto before = std::span(step_height).first(k - kReaches);
    const bool is_peak =
        step_height[k] == std::ranges::max(beside) && step_height[k] > kOfBefore * std::ranges::max(before);
    if (is_peak && step_height[k] > std::max(least, kErrorsOfHeight * std::sqrt(height_variance(P, k) +
                                                                                height_variance(Q, k))))
      return k;
  }
  return n - 1;
}

std::vector<Complex> voltage_steps(const record::Record& record) {
  const auto phasor = [&](std::size_t k) { return std::polar(record.V[k], record.theta[k]); };
  std::vector<Complex> step;
  for (std::size_t k = 0; k + 1 < record.t.size(); ++k) step.push_back(phasor(k + 1) - phasor(k));
  return step;
}

Switching within_step(const record::Record& record, std::size_t k) {
  const double half = (record.t[k + 1] - record.t[k]) / 2;
  return {.time = record.t[k] + half, .uncertainty = half};
}

std::vector<Switching> find_isolated_steps(const record::Record& record, double threshold) {
  constexpr double kOfThreshold = 0.05, kOfAround = 5;
  constexpr std::size_t kAround = 10, kSamplesBefore = 4;  // the record may begin just before the event
  const auto out = extrapolation_errors(voltage_steps(record));
  const auto is_lone = [&](std::size_t k) {
    if (out[k] <= kOfThreshold * threshold) return false;
    for (std::size_t j = k > kAround ? k - kAround : 0; j <= k + kAround; ++j)
      if (j != k && out[k] <= kOfAround * out[j]) return false;
    return true;
  };
  std::vector<Switching> found;
  for (std::size_t k = kSamplesBefore; k + kAround < out.size(); ++k)
    if (is_lone(k)) found.push_back(within_step(record, k));
  return found;
}

std::size_t leaves(std::span<const double> signal, const Leaving& rule) {
  std::size_t off = 0;
  for (std::size_t k = rule.from; k < signal.size(); ++k) {
    off = std::abs(signal[k] - rule.level) > rule.reach ? off + 1 : 0;
    if (off == rule.in_a_row) return k + 1 - rule.in_a_row;
  }
  return signal.size();
}

}  // namespace swingbank::validate::playin
