#pragma once
// How large white noise is, whatever slow course it lies on.
#include <algorithm>
#include <cstddef>
#include <span>

namespace swingbank {

/// Variance by second differences x[k-1] - 2 x[k] + x[k+1], which have six times that of x; a straight course
/// adds nothing. 0 of fewer than three values.
inline double white_variance(std::span<const double> x) {
  double sum = 0;
  for (std::size_t k = 1; k + 1 < x.size(); ++k) {
    const double d = x[k - 1] - 2 * x[k] + x[k + 1];
    sum += d * d;
  }
  return sum / (6.0 * static_cast<double>(std::max<std::size_t>(3, x.size()) - 2));
}

}  // namespace swingbank
