#pragma once
// Hermite interpolation between two nodes of a run.

namespace swingbank::validate::playin {

/// Returns the cubic Hermite interpolant at the fraction `share` of an interval of length h, from the values
/// and derivatives at its ends.
inline double hermite(double share, double h, double from, double derivative_from, double to,
                      double derivative_to) {
  const double rest = 1 - share;
  return rest * rest * ((1 + 2 * share) * from + share * h * derivative_from) +
         share * share * ((1 + 2 * rest) * to - rest * h * derivative_to);
}

}  // namespace swingbank::validate::playin
