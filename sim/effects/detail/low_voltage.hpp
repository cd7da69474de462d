#pragma once
// Reduction of constant power and constant current at low voltage in PSS/E, as given by OpenIPSL
// (Loads.PSSE): both decrease to zero continuously.
#include "sim/core/scalar.hpp"

namespace swingbank::sim::effects::shared {

/// Returns the remaining fraction of a constant power at voltage v > 0, divided by v^2; the quotient is
/// finite at low voltage. With x = v/threshold the fraction is 2 x^2 up to x = 0.5 and 1 - 2 (1 - x)^2 up to
/// x = 1.
template <class T>
inline T power_per_square(const T& v, const T& threshold) {
  const T one(1.0), two(2.0), half = T(0.5) * threshold;
  const T high = select(v > half, v, half), inverse = one / high;
  const T x = high / threshold, missing = positive_part(one - x);
  return (one - two * missing * missing) * inverse * inverse;
}

/// Returns the remaining fraction of a constant current at voltage v, divided by v. The fraction is
/// min(1, a b u^(b-1) exp(-a u^b)) with u = v/(2 threshold), a = 1.502, b = 1.769 (these constants
/// give 1.0035 at the threshold). `v` > 0.
template <class T>
inline T current_per_voltage(const T& v, const T& threshold) {
  using std::exp;
  using std::log;
  const T one(1.0);
  if (!any_positive(threshold - v)) return one / v;
  constexpr double a = 1.502, b = 1.769;
  const T u = T(0.5) * select(v < threshold, v, threshold) / threshold;
  const T power = exp(T(b - 1.0) * log(u));
  const T left = T(a * b) * power * exp(T(0.0) - T(a) * u * power);
  return select(v < threshold, select(left < one, left, one), one) / v;
}

}  // namespace swingbank::sim::effects::shared
