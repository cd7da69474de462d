#pragma once
// Standard deviation of samples.
#include <cmath>
#include <vector>

namespace swingbank::validate::compare {

/// Returns the standard deviation of the first n values; 0 if it is within the rounding error of a file.
inline double standard_deviation(const std::vector<double>& values, int n) {
  constexpr double kNoNoise = 1e-7;  // rounding error of a file with 8 digits
  double mean = 0, square = 0;
  for (int k = 0; k < n; ++k) mean += values[static_cast<std::size_t>(k)] / n;
  for (int k = 0; k < n; ++k) square += std::pow(values[static_cast<std::size_t>(k)] - mean, 2);
  const double s = std::sqrt(square / (n - 1));
  return s > kNoNoise ? s : 0.0;
}

}  // namespace swingbank::validate::compare
