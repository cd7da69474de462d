#include "validate/record_jumps.hpp"

#include <algorithm>
#include <cmath>

#include "validate/voltage_curve.hpp"

namespace swingbank::validate {
namespace {

double written_theta(const Record& r, std::size_t k) {
  return r.theta_as_written.empty() ? r.theta[k] : r.theta_as_written[k];
}

/// Where no single interval stands out, a filter may smear a jump over three: the largest of those.
std::vector<Jump> smeared(const Record& r) {
  constexpr double kLeast = 0.05;  // pu; slow events move less in three samples
  std::vector<Jump> jumps;
  const std::size_t n = r.V.size();
  std::vector<double> size(n, 0.0);
  for (std::size_t k = 1; k + 2 < n; ++k)
    size[k] = std::abs(std::polar(r.V[k + 2], r.theta[k + 2]) - std::polar(r.V[k - 1], r.theta[k - 1]));
  for (std::size_t k = 5; k + 5 < n; ++k)
    if (size[k] > kLeast &&
        size[k] == *std::max_element(size.begin() + static_cast<std::ptrdiff_t>(k) - 4,
                                     size.begin() + static_cast<std::ptrdiff_t>(k) + 5) &&
        size[k] > 4 * std::max(size[k - 4], size[k + 4]))
      jumps.push_back({k - 1, k + 2});
  return jumps;
}

}  // namespace

std::vector<Jump> find_jumps(const Record& r) {
  if (r.samples() < 12) return {};
  std::vector<Jump> jumps;
  for (const auto& s : detect_switchings(r)) {
    const auto k = static_cast<std::size_t>(std::ranges::upper_bound(r.t, s.time) - r.t.begin());
    if (k >= 1 && k < r.t.size()) jumps.push_back({k - 1, k});
  }
  return jumps.empty() ? smeared(r) : jumps;
}

JumpFit fit_jumps(const Record& r, const std::vector<Jump>& jumps, int delay,
                  const Reinterpret& reinterpret) {
  double cross = 0, current = 0, voltage = 0;  // sums of Re(dV conj(-j dI)), |dI|^2, |dV|^2
  const auto reading = [&](std::size_t k, std::size_t power) {
    return reinterpret({r.V[k], written_theta(r, k), r.P[power], r.Q[power]});
  };
  for (const auto& j : jumps) {
    const auto late = [&](std::size_t k) { return static_cast<std::size_t>(static_cast<long>(k) + delay); };
    if (late(j.before) >= r.t.size() || late(j.after) >= r.t.size()) continue;
    const Reading a = reading(j.before, late(j.before)), b = reading(j.after, late(j.after));
    if (!(std::abs(a.V) > 0.02) || !(std::abs(b.V) > 0.02)) continue;  // no current follows from P and Q
    const Complex va = std::polar(std::abs(a.V), a.theta), vb = std::polar(std::abs(b.V), b.theta);
    const Complex di = std::conj(Complex(b.P, b.Q) / vb) - std::conj(Complex(a.P, a.Q) / va);
    cross += std::real((vb - va) * std::conj(Complex(0, -1) * di));
    current += std::norm(di);
    voltage += std::norm(vb - va);
  }
  if (!(current > 0) || !(voltage > 0)) return {std::nan(""), std::nan("")};
  return {cross / current, 1 - cross * cross / (current * voltage)};
}

int power_delay(const Record& r, const std::vector<Jump>& jumps) {
  constexpr int kFarthest = 6;  // samples
  int delay = 0;
  bool first = true;
  const auto n = static_cast<int>(r.t.size());
  for (const auto& j : jumps) {
    const int width = static_cast<int>(j.after - j.before), k = static_cast<int>(j.before);
    if (k < kFarthest + 1 || k + width + kFarthest >= n) continue;
    const auto step = [&](int m) {
      const auto a = static_cast<std::size_t>(k + m), b = static_cast<std::size_t>(k + m + width);
      return std::hypot(r.P[b] - r.P[a], r.Q[b] - r.Q[a]);
    };
    int best = 0;
    for (int m = -kFarthest; m <= kFarthest; ++m)
      if (step(m) > step(best)) best = m;
    // Other switchings nearby, or a flat choice, tell nothing.
    if (best != 0 && !(step(best) > 4 * step(0))) best = 0;
    if (!first && best != delay) return 0;
    delay = best;
    first = false;
  }
  return delay;
}

}  // namespace swingbank::validate
