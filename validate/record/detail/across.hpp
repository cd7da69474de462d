#pragma once
// Interpolation over a gap from the values on both sides.
#include <cstddef>
#include <vector>

namespace swingbank::validate::record {

/// Polynomial through the values beside a gap, with or without a step within it, of the degree with the least
/// Akaike criterion (corrected for few values). Too low a degree misses the curvature of a swing; too high a
/// one follows noise.
struct Across {
  std::vector<double> inside;  ///< values in the gap
  double step = 0;             ///< their step within the gap; 0: smooth
};
/// Interpolates from (`at`, `value`) on both sides to the abscissae `inside`, scaled to about 1 on each side.
/// Requires kMinAcross values.
Across across(const std::vector<double>& at, const std::vector<double>& value,
              const std::vector<double>& inside);
constexpr std::size_t kMinAcross = 6;

}  // namespace swingbank::validate::record
