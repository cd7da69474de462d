#pragma once
// Medians of values that are there.
#include <algorithm>
#include <cstddef>
#include <vector>

namespace swingbank {

/// The upper one of two middle values, so that it is one of the values. `values` is not empty.
inline double upper_median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// The mean of two middle values where their number is even. `values` is not empty.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return values.size() % 2 == 1 ? *middle : (*std::ranges::max_element(values.begin(), middle) + *middle) / 2;
}

}  // namespace swingbank
