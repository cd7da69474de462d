#pragma once
// Standard normal distribution: density, cumulative distribution and its inverse.
#include <cmath>

namespace swingbank::train::posterior {

inline double normal_density(double z) {
  constexpr double kRootTwoPi = 2.5066282746310002;
  return std::exp(-0.5 * z * z) / kRootTwoPi;
}

inline double normal_cdf(double z) { return 0.5 * std::erfc(-z * std::sqrt(0.5)); }

/// Inverse of normal_cdf; p is clamped to [1e-12, 1 - 1e-12].
double normal_quantile(double p);

}  // namespace swingbank::train::posterior
