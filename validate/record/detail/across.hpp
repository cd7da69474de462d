#pragma once
// Interpolation over a gap from the values on both sides.
#include <cstddef>
#include <vector>

namespace swingbank::validate::record {

/// Interpolation by a polynomial fitted to the values on both sides of a gap, and the step in the gap, if
/// any. The polynomial's degree minimises the Akaike criterion (corrected for few values). Too low a degree
/// misses the curvature of a swing; too high a degree follows noise.
struct Across {
  std::vector<double> inside;  ///< values in the gap
  double step = 0;             ///< step in the gap; 0 if the criterion prefers a smooth polynomial
};
/// Interpolates at the abscissae `inside` from the values `value` at the abscissae `at` on both sides. The
/// abscissa 0 is the middle of the gap, and the unit is about the width of the samples used on one side.
/// Requires at least kMinAcross values.
Across across(const std::vector<double>& at, const std::vector<double>& value,
              const std::vector<double>& inside);
constexpr std::size_t kMinAcross = 6;

}  // namespace swingbank::validate::record
