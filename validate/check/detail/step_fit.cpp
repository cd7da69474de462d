#include "validate/check/detail/step_fit.hpp"

#include <algorithm>
#include <cmath>

namespace swingbank::validate::check {
StepFit fit_steps(const record::Record& r, const std::vector<switching::StepInterval>& steps, int delay) {
  double cross = 0, current = 0, voltage = 0, count = 0;  // sums of Re(dV conj(-j dI)), |dI|^2, |dV|^2
  struct Phasors {
    Complex v, i;
  };
  const auto at = [&](std::size_t k) {
    const auto late = static_cast<std::size_t>(static_cast<long>(k) + delay);
    const Complex v = std::polar(std::abs(r.V[k]), r.written_angle()[k]);
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

int power_delay(const record::Record& r, const std::vector<switching::StepInterval>& steps) {
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
