#include "validate/switching/steady.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/white_noise.hpp"
#include "validate/switching/switching.hpp"

namespace swingbank::validate::switching {
namespace {

/// Number of values on either side of a step that determine its height.
constexpr std::size_t kSamplesBeside = 3;

double mean(std::span<const double> x) {
  return Eigen::Map<const Eigen::ArrayXd>(x.data(), static_cast<Eigen::Index>(x.size())).mean();
}
/// Returns the change from the mean of the values up to sample k to the mean of the values after k.
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

std::size_t leaves(std::span<const double> signal, const Leaving& rule) {
  std::size_t off = 0;
  for (std::size_t k = rule.from; k < signal.size(); ++k) {
    off = std::abs(signal[k] - rule.level) > rule.reach ? off + 1 : 0;
    if (off == rule.in_a_row) return k + 1 - rule.in_a_row;
  }
  return signal.size();
}

double steady_until(const record::Record& r) {
  constexpr double kFirstStretch = 0.5, kOffMean = 8;  // [s]; standard deviations
  const auto n = static_cast<std::size_t>(std::lround(kFirstStretch / r.step()));
  if (n < 3 || n + 1 >= r.V.size()) return r.t.back();
  double mean = 0, square = 0;
  for (std::size_t k = 0; k < n; ++k) mean += r.V[k] / static_cast<double>(n);
  for (std::size_t k = 0; k < n; ++k) square += std::pow(r.V[k] - mean, 2) / static_cast<double>(n - 1);
  const double limit = std::max(kOffMean * std::sqrt(square), kLeastNoise);
  const std::size_t k = leaves(r.V, {.level = mean, .reach = limit, .from = n});
  return k < r.V.size() ? r.t[k - 1] : r.t.back();
}

}  // namespace swingbank::validate::switching
