#include "validate/switching/voltage_steps.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "base/median.hpp"

namespace swingbank::validate::switching {
namespace {

/// Returns the distance of x from the straight segment between a and b.
double beyond(Complex x, Complex a, Complex b) {
  const double length = std::norm(b - a);
  const double at = length > 0 ? std::real((x - a) * std::conj(b - a)) / length : 0.0;
  return std::abs(x - a - std::clamp(at, 0.0, 1.0) * (b - a));
}
/// Returns the distance of the change over each sample interval [pu] from the changes two and three intervals
/// before and after it, and from the straight segments between these. The segments cover changes that grow or
/// shrink gradually, as at the end of a converter's ramp or at the turning point of a swing.
std::vector<double> prominence(const std::vector<Complex>& step) {
  std::vector<double> d(step.size(), 0.0);
  for (std::size_t k = 3; k + 3 < step.size(); ++k) {
    d[k] = std::numeric_limits<double>::infinity();
    for (const std::size_t before : {k - 3, k - 2})
      for (const std::size_t after : {k + 2, k + 3})
        d[k] = std::min(d[k], beyond(step[k], step[before], step[after]));
  }
  return d;
}
/// Returns whether intervals first .. last belong to a fast swing, where no change over an interval stands
/// out from its neighbours.
bool is_swing(const std::vector<Complex>& step, const std::vector<double>& d, std::size_t first,
              std::size_t last) {
  constexpr double kOfSwing = 0.25;
  for (std::size_t k = first; k <= last; ++k) {
    double beside = 0;
    for (const std::size_t i : {k - 3, k - 2, k + 2, k + 3}) beside = std::max(beside, std::abs(step[i]));
    if (d[k] >= kOfSwing * beside) return false;
  }
  return true;
}

/// Intervals first .. last over which one step is spread.
struct StepSpan {
  std::size_t first, last;
};
/// Removes intervals at both ends where the voltage only drifts (the changes over consecutive intervals are
/// equal), as in a short fault.
StepSpan trimmed(const std::vector<Complex>& step, StepSpan span, double limit) {
  double largest = 0;
  for (std::size_t i = span.first; i <= span.last; ++i) largest = std::max(largest, std::abs(step[i]));
  const auto belongs = [&](std::size_t i) {
    const double beside = std::min(std::abs(step[i] - step[i - 1]), std::abs(step[i] - step[i + 1]));
    return std::abs(step[i]) > 0.3 * largest || beside > limit;
  };
  while (span.first < span.last && !belongs(span.first)) ++span.first;
  while (span.first < span.last && !belongs(span.last)) --span.last;
  return span;
}
/// Separates the two steps of a short fault that have merged, by their opposite directions.
std::vector<StepSpan> separate_merged(const std::vector<Complex>& step, StepSpan both, double limit) {
  constexpr double kBack = -0.15, kOn = 0.05;  // fraction of the largest change in the first step
  Complex onward = step[both.first];
  for (std::size_t i = both.first; i <= std::min(both.first + 2, both.last); ++i)
    if (std::abs(step[i]) > std::abs(onward)) onward = step[i];
  const auto along = [&](std::size_t i) {
    return std::real(step[i] * std::conj(onward)) / std::norm(onward);
  };
  std::size_t back = both.first;
  while (back <= both.last && along(back) > kBack) ++back;
  if (back > both.last) return {trimmed(step, both, limit)};
  std::size_t end = both.first;
  for (std::size_t i = both.first; i < back; ++i)
    if (along(i) > kOn) end = i;
  return {trimmed(step, {both.first, end}, limit), trimmed(step, {back, both.last}, limit)};
}

/// Largest change per interval of a decay after a step, as a fraction of the step.
constexpr double kOfPeak = 0.5;

std::size_t largest_of(const std::vector<Complex>& step, StepSpan span) {
  const auto at = step.begin();
  const auto from = static_cast<std::ptrdiff_t>(span.first), to = static_cast<std::ptrdiff_t>(span.last);
  return static_cast<std::size_t>(
      std::max_element(at + from, at + to + 1,
                       [](Complex a, Complex b) { return std::abs(a) < std::abs(b); }) -
      at);
}
/// Returns whether a subtransient decay follows the sharp step in interval m. An instrument's window is
/// symmetric and decreases to both sides. If its middle lies in m, the part of the step in m - 1 is at least
/// that in m + 2. A machine responds only after the step.
bool decays_after(const std::vector<Complex>& step, std::size_t m, double limit) {
  constexpr double kOfNext = 0.15, kOfLimit = 0.25;  // allowance for the rotor's swing
  constexpr double kLess = 0.9;                      // above it the next step begins
  const Complex next = step[m + 1];
  if (std::abs(next) <= limit || std::abs(next) > kOfPeak * std::abs(step[m])) return false;
  if (std::real(next * std::conj(step[m])) < 0) return false;
  const double goes_on = std::real(step[m + 2] * std::conj(next)) / std::abs(next);
  return goes_on < kLess * std::abs(next) &&
         goes_on - std::abs(step[m - 1]) > std::max(kOfNext * std::abs(next), kOfLimit * limit);
}
/// Returns whether a filter is centred in interval m: the changes in both neighbouring intervals are equal.
bool is_even(const std::vector<Complex>& step, std::size_t m, double limit) {
  const Complex before = step[m - 1], after = step[m + 1];
  return std::abs(before - after) < limit && std::abs(before - step[m - 2]) > limit &&
         std::abs(after - step[m + 2]) > limit && std::real(before * std::conj(step[m])) > 0;
}
/// Returns whether one interval contains a sharp step, and the others only the machine's response.
bool has_peak(const std::vector<Complex>& step, StepSpan span, std::size_t m) {
  for (std::size_t k = span.first; k <= span.last; ++k)
    if (k != m && std::abs(step[k]) > kOfPeak * std::abs(step[m])) return false;
  return true;
}

constexpr double kGoodPart = 0.15;  ///< fraction of a step's largest change

/// Returns the distance of the change over each sample interval from the extrapolation of the two changes
/// before it or of the two after it, whichever is smaller [pu]. The change at a switching differs from both
/// extrapolations, the change next to it from one, and a rotor swing from neither.
std::vector<double> extrapolation_errors(const std::vector<Complex>& step) {
  std::vector<double> out(step.size(), 0.0);
  for (std::size_t k = 2; k + 2 < step.size(); ++k)
    out[k] = std::min(std::abs(step[k] - 2.0 * step[k - 1] + step[k - 2]),
                      std::abs(step[k] - 2.0 * step[k + 1] + step[k + 2]));
  return out;
}

}  // namespace

VoltageSteps::VoltageSteps(const record::Record& record, const std::vector<double>& theta)
    : record_(&record) {
  const auto phasor = [&](std::size_t k) { return std::polar(record.V[k], theta[k]); };
  for (std::size_t k = 0; k + 1 < record.t.size(); ++k) step_.push_back(phasor(k + 1) - phasor(k));
  prominence_ = prominence(step_);
}

double VoltageSteps::min_step_size(double threshold) const {
  return std::max(threshold, 10 * upper_median(prominence_));
}

/// Returns a switching between samples k and k + 1.
Switching VoltageSteps::within_step(std::size_t k) const {
  const double half = (record_->t[k + 1] - record_->t[k]) / 2;
  return {.time = record_->t[k] + half, .uncertainty = half};
}

std::vector<Switching> VoltageSteps::isolated_steps(double threshold) const {
  constexpr double kOfThreshold = 0.05, kOfAround = 5;
  constexpr std::size_t kAround = 10, kSamplesBefore = 4;  // the record may begin just before the event
  const auto out = extrapolation_errors(step_);
  const auto is_lone = [&](std::size_t k) {
    if (out[k] <= kOfThreshold * threshold) return false;
    for (std::size_t j = k > kAround ? k - kAround : 0; j <= k + kAround; ++j)
      if (j != k && out[k] <= kOfAround * out[j]) return false;
    return true;
  };
  std::vector<Switching> found;
  for (std::size_t k = kSamplesBefore; k + kAround < out.size(); ++k)
    if (is_lone(k)) found.push_back(within_step(k));
  return found;
}

std::vector<Switching> VoltageSteps::detect(double threshold) const {
  const std::size_t steps = step_.size();
  // The change at a step differs from both neighbours; the change next to a step differs from one only.
  std::vector<double> spike(steps, 0.0);
  for (std::size_t k = 1; k + 1 < steps; ++k)
    spike[k] = std::min(std::abs(step_[k] - step_[k - 1]), std::abs(step_[k] - step_[k + 1]));
  const double limit = std::max(threshold, 10 * upper_median(spike));
  std::vector<Switching> found;
  for (std::size_t k = 1; k + 1 < steps; ++k)
    if (spike[k] > limit) found.push_back(within_step(k));
  return found.empty() ? isolated_steps(threshold) : found;
}

SwitchingTimes VoltageSteps::find(double threshold, StepShape shape) const {
  const std::vector<double>& d = prominence_;
  const double limit = min_step_size(threshold);
  SwitchingTimes found{{}, std::vector<char>(record_->t.size(), 0)};
  for (std::size_t k = 0; k < d.size(); ++k) {
    if (d[k] <= limit) continue;
    std::size_t last = k;
    while (last + 1 < d.size() && d[last + 1] > limit) ++last;
    // one interval within a spread step may happen to equal its neighbours
    if (last + 2 < d.size() && d[last + 2] > limit) {
      last += 2;
      while (last + 1 < d.size() && d[last + 1] > limit) ++last;
    }
    if (is_swing(step_, d, k, std::min(last, d.size() - 4))) continue;
    // samples first + 1 .. last lie inside the step
    for (StepSpan span : separate_merged(step_, {k, last}, limit)) {
      if (shape == StepShape::either && span.first == span.last && is_even(step_, span.first, limit))
        span = {span.first - 1, span.first + 1};
      if (shape != StepShape::filtered && span.last > span.first)
        if (const std::size_t m = largest_of(step_, span);
            shape == StepShape::sharp ? has_peak(step_, span, m) : decays_after(step_, m, limit))
          span = {m, m};
      const bool wide = span.last > span.first, filtered = wide || shape == StepShape::filtered;
      if (wide && shape == StepShape::sharp) continue;
      const double from = record_->t[span.first], to = record_->t[span.last + 1];
      found.switchings.push_back({(from + to) / 2, (to - from) / 2 + (filtered ? record_->step() : 0.0)});
      if (filtered)
        for (std::size_t s = span.first; s <= span.last + 1; ++s) found.filtered_samples[s] = 1;
    }
    k = last;
  }
  if (found.switchings.empty() && shape != StepShape::filtered)
    found.switchings = isolated_steps(2 * threshold);
  return found;
}

/// Returns whether a filter has spread a step over several intervals, so that a large part of the step lies
/// in a neighbouring interval. A smaller part may also come from a subtransient, whose further decay is
/// hidden if the fault lasts only two samples.
bool VoltageSteps::is_shared_out(const Switching& switching) const {
  std::size_t m = 1;
  for (std::size_t k = 1; k + 1 < step_.size(); ++k)
    if (std::abs(record_->t[k] - switching.time) < switching.uncertainty &&
        std::abs(step_[k]) > std::abs(step_[m]))
      m = k;
  const auto along = [&](std::size_t k) { return std::real(step_[k] * std::conj(step_[m])); };
  return std::max(along(m - 1), along(m + 1)) > kGoodPart * std::norm(step_[m]);
}

/// Returns whether the record's first step is unfiltered. Either a decay follows it, or it is large or
/// isolated and begins suddenly. A filtered step would spread over two intervals, or begin in the interval
/// before.
bool VoltageSteps::is_sharp(const Switching& first, double threshold) const {
  constexpr double kClear = 10, kBegins = 0.03;
  const auto k = static_cast<std::size_t>(
      std::ranges::find_if(record_->t, [&](double t) { return t > first.time; }) - record_->t.begin());
  if (decays_after(step_, k - 1, min_step_size(threshold))) return true;
  const double size = std::abs(step_[k - 1]);
  const bool alone = k + 1 < step_.size() && std::abs(step_[k] - step_[k + 1]) < kGoodPart * size;
  return (size > kClear * threshold || alone) && std::abs(step_[k - 2]) < kBegins * size;
}

StepShape VoltageSteps::shape_of_first(const std::vector<Switching>& found, double threshold) const {
  if (found.empty()) return StepShape::either;
  if (found.front().uncertainty > record_->step() && is_shared_out(found.front())) return StepShape::filtered;
  return is_sharp(found.front(), threshold) ? StepShape::sharp : StepShape::either;
}

bool VoltageSteps::moves_before_given(double threshold) const {
  constexpr double kBegins = 0.03;
  const record::Record& r = *record_;
  const double last = r.switched.front() + r.time_slack();
  const auto k = static_cast<std::size_t>(std::ranges::upper_bound(r.t, last) - r.t.begin());
  if (k < 2 || k >= r.t.size()) return false;
  return std::abs(step_[k - 2]) > std::max(threshold / 2, kBegins * std::abs(step_[k - 1]));
}

}  // namespace swingbank::validate::switching
