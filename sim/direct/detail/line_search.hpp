#pragma once
// Search for all local minima of a function of one variable by a grid and golden sections.
#include <algorithm>
#include <vector>

#include "base/golden_section.hpp"

namespace swingbank::sim::direct {

/// Returns the local minima on a grid of `points` values, smallest first. Each is refined between its
/// neighbours to 1e-8 of their distance.
template <class F>
std::vector<Minimum> minima(const F& f, double low, double high, int points) {
  constexpr int kSections = 40;
  const double step = (high - low) / (points - 1);
  std::vector<double> values;
  for (int k = 0; k < points; ++k) values.push_back(f(low + k * step));
  std::vector<Minimum> found;
  for (int k = 0; k < points; ++k) {
    const auto i = static_cast<std::size_t>(k);
    if ((k > 0 && values[i - 1] < values[i]) || (k + 1 < points && values[i + 1] < values[i])) continue;
    found.push_back(golden_section(f, low + std::max(k - 1, 0) * step,
                                   low + std::min(k + 1, points - 1) * step,
                                   [](int sections, double) { return sections < kSections; }));
  }
  std::ranges::sort(found, {}, &Minimum::value);
  return found;
}

}  // namespace swingbank::sim::direct
