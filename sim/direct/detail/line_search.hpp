#pragma once
// Minima of a function of one variable: a grid, then golden sections.
#include <algorithm>
#include <vector>

namespace swingbank::sim::direct {

struct Minimum {
  double at = 0, value = 0;
};

/// Refines a minimum between two bounds to their distance times 0.618^steps.
template <class F>
Minimum golden(const F& f, double low, double high, int steps = 40) {
  constexpr double kGolden = 0.6180339887498949;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double fa = f(a), fb = f(b);
  for (int i = 0; i < steps; ++i) {
    if (fa < fb) {
      high = b;
      b = a;
      fb = fa;
      a = high - kGolden * (high - low);
      fa = f(a);
    } else {
      low = a;
      a = b;
      fa = fb;
      b = low + kGolden * (high - low);
      fb = f(b);
    }
  }
  return fa < fb ? Minimum{a, fa} : Minimum{b, fb};
}

/// The local minima among values on a grid of `points`, each refined between its neighbours; smallest first.
template <class F>
std::vector<Minimum> minima(const F& f, double low, double high, int points) {
  const double step = (high - low) / (points - 1);
  std::vector<double> values;
  for (int k = 0; k < points; ++k) values.push_back(f(low + k * step));
  std::vector<Minimum> found;
  for (int k = 0; k < points; ++k) {
    const auto i = static_cast<std::size_t>(k);
    if ((k > 0 && values[i - 1] < values[i]) || (k + 1 < points && values[i + 1] < values[i])) continue;
    found.push_back(golden(f, low + std::max(k - 1, 0) * step, low + std::min(k + 1, points - 1) * step));
  }
  std::ranges::sort(found, {}, &Minimum::value);
  return found;
}

}  // namespace swingbank::sim::direct
