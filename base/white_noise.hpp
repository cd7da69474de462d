#pragma once
// Variance of white noise on a slowly varying signal.
#include <algorithm>
#include <cstddef>
#include <span>

namespace swingbank {

/// Returns the noise variance from second differences \f$ d_k = x_{k-1} - 2 x_k + x_{k+1} \f$, whose variance
/// is \f$ 6 \sigma^2 \f$. A linear trend cancels. Returns 0 for fewer than three values.
inline double white_variance(std::span<const double> x) {
  double sum = 0;
  for (std::size_t k = 1; k + 1 < x.size(); ++k) {
    const double d = x[k - 1] - 2 * x[k] + x[k + 1];
    sum += d * d;
  }
  return sum / (6.0 * static_cast<double>(std::max<std::size_t>(3, x.size()) - 2));
}

}  // namespace swingbank
