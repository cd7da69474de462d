#pragma once
// The standard normal distribution and its inverse.
#include <algorithm>
#include <cmath>

namespace swingbank::train::posterior {

inline double normal_density(double z) {
  constexpr double kRootTwoPi = 2.5066282746310002;
  return std::exp(-0.5 * z * z) / kRootTwoPi;
}

inline double normal_cdf(double z) { return 0.5 * std::erfc(-z * std::sqrt(0.5)); }

/// Returns the quantile of p in (0, 1), clamped to [1e-12, 1 - 1e-12]. Newton's method on the logarithm of
/// the tail.
inline double normal_quantile(double p) {
  constexpr double kTail = 1e-12;
  const double tail = std::clamp(std::min(p, 1.0 - p), kTail, 0.5);
  double z = -std::sqrt(-2.0 * std::log(2.0 * tail));  // below the root for every tail
  for (int i = 0; i < 30; ++i) {
    const double found = normal_cdf(z);
    const double step = std::log(found / tail) * found / normal_density(z);
    z -= step;
    if (std::abs(step) < 1e-13) break;
  }
  return p < 0.5 ? z : -z;
}

}  // namespace swingbank::train::posterior
