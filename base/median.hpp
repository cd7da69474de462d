#pragma once
// Medians of non-empty lists.
#include <algorithm>
#include <cstddef>
#include <vector>

namespace swingbank {

/// Returns the upper median, which is always an element of `values`. `values` must not be empty.
inline double upper_median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Returns the median: for an even count, the mean of the two middle values. `values` must not be empty.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return values.size() % 2 == 1 ? *middle : (*std::ranges::max_element(values.begin(), middle) + *middle) / 2;
}

}  // namespace swingbank
