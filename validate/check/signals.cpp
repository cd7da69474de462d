#include "validate/check/signals.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <span>

#include "base/constants.hpp"
#include "base/median.hpp"
#include "validate/switching/steady.hpp"
#include "validate/switching/step_intervals.hpp"
#include "validate/switching/voltage_steps.hpp"

namespace swingbank::validate::check {
namespace {

/// Median magnitude of second differences of Gaussian noise, per standard deviation: 0.6745 sqrt(1 + 4 + 1).
constexpr double kMedianSecondDifference = 0.6745 * 2.449489742783178;

/// Least-squares line through values at 0, 1, 2, …: value in the middle, slope, standard deviation about it.
struct Line {
  double middle = 0, slope = 0, standard_deviation = 0;
};
Line fit_line(std::span<const double> y) {
  const auto n = static_cast<double>(y.size());
  double mean = 0, xy = 0, xx = 0, square = 0;
  for (const double v : y) mean += v / n;
  for (std::size_t k = 0; k < y.size(); ++k) {
    const double x = static_cast<double>(k) - (n - 1) / 2;
    xy += x * (y[k] - mean);
    xx += x * x;
  }
  const double slope = xx > 0 ? xy / xx : 0.0;
  for (std::size_t k = 0; k < y.size(); ++k)
    square += std::pow(y[k] - mean - slope * (static_cast<double>(k) - (n - 1) / 2), 2);
  return {mean, slope, n > 2 ? std::sqrt(square / (n - 2)) : 0.0};
}

/// Estimates the noise of a channel. White noise is estimated from second differences. Filtered noise is too
/// slow for second differences, so it is estimated from the standard deviation of the quietest second.
void find_noise(const std::vector<double>& y, double rate, SignalFacts& facts) {
  std::vector<double> second;
  for (std::size_t k = 1; k + 1 < y.size(); ++k) second.push_back(std::abs(y[k - 1] - 2 * y[k] + y[k + 1]));
  const auto width = std::clamp<std::size_t>(static_cast<std::size_t>(rate), 10, y.size());
  double quietest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k + width <= y.size(); k += std::max<std::size_t>(width / 2, 1))
    quietest = std::min(quietest, fit_line(std::span(y).subspan(k, width)).standard_deviation);
  facts.white = median_of(std::move(second)) / kMedianSecondDifference;
  facts.quietest = quietest;
  facts.noise = std::max(facts.white, quietest);
}

std::span<const double> until(const std::vector<double>& y, std::size_t last) {
  return std::span(y).first(std::min(last + 1, y.size()));
}
double median_in(std::span<const double> y) { return median_of(std::vector<double>(y.begin(), y.end())); }

/// Returns the first sample at which the frequency has changed by more than 20 mHz and more than the noise;
/// the number of samples if there is none. The frequency is the change of the angle over half a second. It is
/// the first signal that shows a slow event.
std::size_t turns_faster(const record::Record& r) {
  constexpr double kSpan = 0.5, kLeastDrift = constants::turn * 0.02;  // s, rad/s
  const auto m = static_cast<std::size_t>(kSpan * r.rate());
  const std::size_t n = r.theta.size();
  if (m < 1 || n < m + 20) return n;
  std::vector<double> turned(n - m);
  for (std::size_t k = 0; k + m < n; ++k) turned[k] = r.theta[k + m] - r.theta[k];
  SignalFacts noise;
  find_noise(r.theta, r.rate(), noise);
  const double reach = std::max(6 * 1.1 * std::numbers::sqrt2 * noise.white, kLeastDrift * kSpan);
  const std::size_t k =
      switching::leaves(turned, {.level = median_in(std::span(turned).first(10)), .reach = reach});
  return k < turned.size() ? k + m : n;
}

/// Returns the first sample within half a second before `first_step` at which the voltage changes by more
/// than ten times the usual amount and 0.002 pu; `first_step` if there is none. A filtered step, or an
/// earlier step below the threshold of find_steps(), begins there.
std::size_t step_before(const record::Record& r, std::size_t first_step) {
  std::vector<double> steps;
  const std::vector<Complex> all = switching::voltage_steps(r);
  for (std::size_t k = 0; k < first_step; ++k) steps.push_back(std::abs(all[k]));
  const double limit = std::max(10 * median_in(steps), 0.002);
  const auto back = static_cast<std::size_t>(0.5 * r.rate());
  for (std::size_t k = first_step > back ? first_step - back : 0; k < first_step; ++k)
    if (steps[k] > limit) return k;
  return first_step;
}

/// Finds the start of the event: the sample before the first step. Without steps it is the sample before a
/// channel first leaves the noise band around its first samples.
void find_event(const record::Record& r, Signals& s) {
  const auto steps = switching::find_steps(r);
  const std::size_t n = r.t.size();
  if (!steps.empty()) {
    s.event = true;
    s.onset = step_before(r, steps.front().before);
    s.last = steps.back().before;
    return;
  }
  std::size_t first = n;
  const std::pair<const std::vector<double>*, SignalFacts*> channels[] = {
      {&r.V, &s.V}, {&r.P, &s.P}, {&r.Q, &s.Q}};
  for (const auto& [y, facts] : channels) {
    // Six standard deviations, because ten thousand samples of Gaussian noise stay below five. The minimum of
    // 1e-4 pu covers rounding in records without noise.
    const double reach = std::max(6 * facts->noise, 1e-4);
    first = std::min(
        first, switching::leaves(*y, {.level = median_in(std::span(*y).first(10)), .reach = reach * 1.1}));
  }
  first = std::min(first, turns_faster(r));
  s.event = s.slow = first < n;
  s.onset = s.last = first > 0 && first < n ? first - 1 : 0;
}

void describe(const record::Record& r, const std::vector<double>& y, const Signals& s, SignalFacts& facts) {
  // The measuring window of a PMU reaches across the event, so the last 50 ms before it are excluded.
  const auto guard = static_cast<std::size_t>(std::ceil(0.05 * r.rate()));
  // A slow event begins before it is detected, so only the first half of the samples before it is used.
  const std::size_t clear = s.slow ? s.onset / 2 : s.onset > guard ? s.onset - guard : 0;
  const auto before = s.event ? until(y, clear) : std::span<const double>(y);
  facts.level = median_in(before);
  for (const double v : y) facts.reach = std::max(facts.reach, std::abs(v - facts.level));
  if (before.size() < 10) return;
  const Line line = fit_line(before);
  const auto n = static_cast<double>(before.size());
  facts.drift = line.slope * (n - 1);
  facts.swing = line.standard_deviation;
  facts.drift_error = std::max(line.standard_deviation, facts.noise) * std::sqrt(12 / n);
}

std::vector<double> differences(const std::vector<double>& y) {
  std::vector<double> steps;
  for (std::size_t k = 0; k + 1 < y.size(); ++k) steps.push_back(y[k + 1] - y[k]);
  return steps;
}

/// Returns the running mean over 2m + 1 values.
std::vector<double> smoothed(const std::vector<double>& y, std::size_t m) {
  std::vector<double> mean;
  for (std::size_t k = m; k + m < y.size(); ++k) {
    double sum = 0;
    for (std::size_t j = k - m; j <= k + m; ++j) sum += y[j];
    mean.push_back(sum / static_cast<double>(2 * m + 1));
  }
  return mean;
}

/// Returns the ratio of the angle's rate [pu of nominal frequency] to the deviation of frequency or speed
/// [pu]; 0 unless both are clearly correlated.
double angle_per_frequency(const record::Record& r, const std::vector<double>& theta) {
  const std::vector<double>& f = r.f.empty() ? r.speed : r.f;
  if (f.size() != theta.size() || f.size() < 40) return 0;
  std::vector<double> rate = differences(theta), mid;
  for (double& v : rate) v /= r.step() * constants::turn * r.base.frequency;
  // Steps and wraps of the angle are no rates, so the largest 3 % are replaced.
  std::vector<double> size(rate.size());
  std::ranges::transform(rate, size.begin(), [](double v) { return std::abs(v); });
  std::vector<double> sorted = size;
  const auto rank = static_cast<std::ptrdiff_t>(sorted.size() * 97 / 100);
  std::ranges::nth_element(sorted, sorted.begin() + rank);
  for (std::size_t k = 0; k < rate.size(); ++k)
    if (size[k] > sorted[static_cast<std::size_t>(rank)]) rate[k] = k > 0 ? rate[k - 1] : 0.0;
  for (std::size_t k = 0; k + 1 < f.size(); ++k) mid.push_back((f[k] + f[k + 1]) / 2);
  const auto m = static_cast<std::size_t>(std::clamp(0.1 * r.rate(), 1.0, 30.0));
  const std::vector<double> a = smoothed(rate, m), b = smoothed(mid, m);
  double am = 0, bm = 0, aa = 0, bb = 0, ab = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    am += a[k] / static_cast<double>(a.size());
    bm += b[k] / static_cast<double>(a.size());
  }
  for (std::size_t k = 0; k < a.size(); ++k) {
    aa += (a[k] - am) * (a[k] - am);
    bb += (b[k] - bm) * (b[k] - bm);
    ab += (a[k] - am) * (b[k] - bm);
  }
  if (!(aa > 0) || !(bb > 0) || ab < 0.7 * std::sqrt(aa * bb)) return 0;
  return std::sqrt(aa / bb);
}

void describe_angle(const record::Record& r, Signals& s) {
  const std::vector<double>& theta = r.written_angle();
  s.first_angle = theta.front();
  s.theta_level = median_in(s.event ? until(theta, s.onset) : std::span<const double>(theta));
  std::vector<double> steps = differences(theta);
  for (const double d : steps) s.wraps_of_360 = s.wraps_of_360 || (std::abs(d) > 320 && std::abs(d) < 400);
  const std::vector<double> turns = differences(r.theta);
  s.angle_rate =
      median_in(s.event && s.onset >= 2 ? until(turns, s.onset - 1) : std::span<const double>(turns)) /
      r.step();
  // The rate is taken over 0.1 s to suppress noise, but at most over half of the record.
  const auto apart = std::clamp<std::size_t>(static_cast<std::size_t>(0.1 * r.rate()), 1,
                                             std::max<std::size_t>(theta.size() / 2, 1));
  std::vector<double> fast;
  for (std::size_t k = 0; k + apart < theta.size(); ++k)
    fast.push_back(std::abs(theta[k + apart] - theta[k]) / (static_cast<double>(apart) * r.step()));
  if (fast.empty()) return;
  const auto rank = static_cast<std::ptrdiff_t>(fast.size() * 70 / 100);
  std::ranges::nth_element(fast, fast.begin() + rank);
  s.fast_angle = fast[static_cast<std::size_t>(rank)];
  s.angle_per_frequency = angle_per_frequency(r, theta);
}

void find_repeats(const record::Record& r, Signals& s) {
  if (!(s.P.quietest > 2e-5)) return;  // without noise, constant values are no defect
  std::size_t run = 0;
  for (std::size_t k = 1; k < r.t.size(); ++k) {
    const bool same =
        r.V[k] == r.V[k - 1] && r.theta[k] == r.theta[k - 1] && r.P[k] == r.P[k - 1] && r.Q[k] == r.Q[k - 1];
    run = same ? run + 1 : 0;
    if (run > s.longest_repeat) s.longest_repeat = run, s.repeat_start = k + 1 - run;
  }
}

}  // namespace

double median_of(std::vector<double> values) { return values.empty() ? 0 : upper_median(std::move(values)); }

Signals record_signals(const record::Record& r) {
  Signals s;
  const double rate = r.rate();
  find_noise(r.V, rate, s.V);
  find_noise(r.P, rate, s.P);
  find_noise(r.Q, rate, s.Q);
  find_event(r, s);
  describe(r, r.V, s, s.V);
  describe(r, r.P, s, s.P);
  describe(r, r.Q, s, s.Q);
  describe_angle(r, s);
  find_repeats(r, s);
  return s;
}

}  // namespace swingbank::validate::check
