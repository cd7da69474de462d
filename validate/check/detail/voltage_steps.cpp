#include "validate/check/detail/voltage_steps.hpp"

#include <algorithm>
#include <cmath>

#include "validate/playin/voltage_curve.hpp"

namespace swingbank::validate::check {
namespace {

double written_theta(const record::Record& r, std::size_t k) {
  return r.theta_as_written.empty() ? r.theta[k] : r.theta_as_written[k];
}

/// Finds steps that a filter spreads over several intervals: changes over three intervals that exceed their
/// surroundings.
std::vector<VoltageStep> find_filtered_steps(const record::Record& r) {
  constexpr double kMinStep = 0.03;  // pu
  std::vector<VoltageStep> steps;
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
/// [pu], the denominator of quotients of steps.
double step_height(const record::Record& r, std::size_t k) {
  if (k < 1 || k + 2 >= r.t.size()) return 0;
  const auto step = [&](std::size_t i) {
    return std::polar(r.V[i + 1], r.theta[i + 1]) - std::polar(r.V[i], r.theta[i]);
  };
  return std::abs(step(k) - 0.5 * (step(k - 1) + step(k + 1)));
}

}  // namespace

std::vector<VoltageStep> find_steps(const record::Record& r) {
  if (r.samples() < 12) return {};
  std::vector<VoltageStep> steps;
  const auto add = [&](double t) {
    const auto k = static_cast<std::size_t>(std::ranges::upper_bound(r.t, t) - r.t.begin());
    if (k >= 1 && k < r.t.size()) steps.push_back({k - 1, k});
  };
  if (!r.switched.empty()) {
    std::ranges::for_each(r.switched, add);
    return steps;
  }
  for (const auto& s : playin::detect_switchings(r)) add(s.time);
  for (const auto& wide : find_filtered_steps(r)) {
    const auto close = [&](const VoltageStep& j) {
      return j.before + 4 > wide.before && wide.after + 4 > j.after;
    };
    if (std::ranges::none_of(steps, close)) steps.push_back(wide);
  }
  std::ranges::sort(steps, {}, &VoltageStep::before);
  return steps;
}

std::vector<VoltageStep> find_large_steps(const record::Record& r) {
  std::vector<VoltageStep> steps = find_steps(r);
  std::erase_if(steps, [&](const VoltageStep& j) {
    return r.switched.empty() && j.after == j.before + 1 && step_height(r, j.before) < playin::kStepThreshold;
  });
  return steps;
}

StepFit fit_steps(const record::Record& r, const std::vector<VoltageStep>& steps, int delay) {
  double cross = 0, current = 0, voltage = 0, count = 0;  // sums of Re(dV conj(-j dI)), |dI|^2, |dV|^2
  struct Phasors {
    Complex v, i;
  };
  const auto at = [&](std::size_t k) {
    const auto late = static_cast<std::size_t>(static_cast<long>(k) + delay);
    const Complex v = std::polar(std::abs(r.V[k]), written_theta(r, k));
    return Phasors{v, std::conj(Complex(r.P[late], r.Q[late]) / v)};
  };
  for (const auto& j : steps) {
    if (static_cast<long>(j.before) - 1 + std::min(delay, 0) < 0) continue;
    if (j.after + 1 + static_cast<std::size_t>(std::max(delay, 0)) >= r.t.size()) continue;
    // The mean of the adjacent changes is subtracted to remove the rotor's swing. The same linear operation
    // on voltage and current preserves the relation of their steps.
    const Phasors p[] = {at(j.before - 1), at(j.before), at(j.after), at(j.after + 1)};
    if (std::ranges::any_of(p, [](const Phasors& x) { return !(std::abs(x.v) > 0.02); })) continue;
    const double half = static_cast<double>(j.after - j.before) / 2;
    const Complex dv = p[2].v - p[1].v - half * (p[1].v - p[0].v + p[3].v - p[2].v);
    const Complex di = p[2].i - p[1].i - half * (p[1].i - p[0].i + p[3].i - p[2].i);
    cross += std::real(dv * std::conj(Complex(0, -1) * di));
    current += std::norm(di);
    voltage += std::norm(dv);
    ++count;
  }
  if (!(current > 0) || !(voltage > 0)) return {std::nan(""), std::nan(""), 0, 0};
  return {cross / current, 1 - cross * cross / (current * voltage), voltage / count, current / count};
}

int power_delay(const record::Record& r, const std::vector<VoltageStep>& steps) {
  constexpr int kFarthest = 6;  // samples
  int delay = 0;
  bool first = true;
  const auto n = static_cast<int>(r.t.size());
  for (const auto& j : steps) {
    const int width = static_cast<int>(j.after - j.before), k = static_cast<int>(j.before);
    if (k < kFarthest + 1 || k + width + kFarthest >= n) continue;
    const auto step = [&](int m) {
      const auto a = static_cast<std::size_t>(k + m), b = static_cast<std::size_t>(k + m + width);
      return std::hypot(r.P[b] - r.P[a], r.Q[b] - r.Q[a]);
    };
    int best = 0;
    for (int m = -kFarthest; m <= kFarthest; ++m)
      if (step(m) > step(best)) best = m;
    // Nearby switchings, or a flat maximum, are not conclusive.
    if (best != 0 && !(step(best) > 4 * step(0))) best = 0;
    if (!first && best != delay) return 0;
    delay = best;
    first = false;
  }
  return delay;
}

}  // namespace swingbank::validate::check
