#include "validate/switching/step_intervals.hpp"

#include <algorithm>
#include <cmath>

#include "validate/switching/voltage_steps.hpp"

namespace swingbank::validate::switching {
namespace {

/// Finds steps that a filter spreads over several intervals. Such a step is a change over three intervals
/// that exceeds its surroundings.
std::vector<StepInterval> find_filtered_steps(const record::Record& r) {
  constexpr double kMinStep = 0.03;  // pu
  std::vector<StepInterval> steps;
  const std::size_t n = r.V.size();
  std::vector<double> size(n, 0.0);
  for (std::size_t k = 1; k + 2 < n; ++k)
    size[k] = std::abs(std::polar(r.V[k + 2], r.theta[k + 2]) - std::polar(r.V[k - 1], r.theta[k - 1]));
  std::vector<double> sorted = size;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(n / 2);
  std::ranges::nth_element(sorted, middle);
  const double limit = std::max(kMinStep, 5 * *middle);
  for (std::size_t k = 5; k + 5 < n; ++k) {
    const auto at = size.begin() + static_cast<std::ptrdiff_t>(k);
    if (*at > limit && *at == *std::max_element(at - 4, at + 5) && *at > 4 * std::max(*(at - 4), *(at + 4)))
      steps.push_back({k - 1, k + 2});
  }
  return steps;
}

/// Returns the change of the voltage phasor over sample interval k minus the mean of the adjacent changes
/// [pu]. It is the denominator of the ratio of the steps of current and voltage.
double step_height(const record::Record& r, std::size_t k) {
  if (k < 1 || k + 2 >= r.t.size()) return 0;
  const auto step = [&](std::size_t i) {
    return std::polar(r.V[i + 1], r.theta[i + 1]) - std::polar(r.V[i], r.theta[i]);
  };
  return std::abs(step(k) - 0.5 * (step(k - 1) + step(k + 1)));
}

}  // namespace

std::vector<StepInterval> find_steps(const record::Record& r) {
  if (r.samples() < 12) return {};
  std::vector<StepInterval> steps;
  const auto add = [&](double t) {
    const auto k = static_cast<std::size_t>(std::ranges::upper_bound(r.t, t) - r.t.begin());
    if (k >= 1 && k < r.t.size()) steps.push_back({k - 1, k});
  };
  if (!r.switched.empty()) {
    std::ranges::for_each(r.switched, add);
    return steps;
  }
  for (const auto& s : detect_switchings(r)) add(s.time);
  for (const auto& wide : find_filtered_steps(r)) {
    const auto close = [&](const StepInterval& j) {
      return j.before + 4 > wide.before && wide.after + 4 > j.after;
    };
    if (std::ranges::none_of(steps, close)) steps.push_back(wide);
  }
  std::ranges::sort(steps, {}, &StepInterval::before);
  return steps;
}

std::vector<StepInterval> find_large_steps(const record::Record& r) {
  std::vector<StepInterval> steps = find_steps(r);
  std::erase_if(steps, [&](const StepInterval& j) {
    return r.switched.empty() && j.after == j.before + 1 && step_height(r, j.before) < kStepThreshold;
  });
  return steps;
}

}  // namespace swingbank::validate::switching
