#pragma once
// How far values scatter.
#include <cmath>
#include <vector>

namespace swingbank::validate::compare {

/// Standard deviation of the first n values; 0 where it is no more than a file's rounding leaves.
inline double spread(const std::vector<double>& values, int n) {
  constexpr double kNoNoise =
      1e-7;  // a file of 8 digits leaves this; below it there is no noise to compare with
  double mean = 0, square = 0;
  for (int k = 0; k < n; ++k) mean += values[static_cast<std::size_t>(k)] / n;
  for (int k = 0; k < n; ++k) square += std::pow(values[static_cast<std::size_t>(k)] - mean, 2);
  const double s = std::sqrt(square / (n - 1));
  return s > kNoNoise ? s : 0.0;
}

}  // namespace swingbank::validate::compare
