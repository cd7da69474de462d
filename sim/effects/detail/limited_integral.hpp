#pragma once
// The integral of a PI regulator that stops while the regulator's output stands beyond a limit.
#include "sim/core/scalar.hpp"

namespace swingbank::sim::effects::shared {

inline constexpr double kIntegralBand = 2e-3;  ///< beyond a limit, where a PI's integral comes to rest [pu]

/// Slope of a PI's integral: none while its output, `out` before the limits, stands beyond one and `slope`
/// would lead further. It fades out over a narrow band: cut off at once, it has no solution where the
/// proportional part falls while the integral rises (the output would slide along the limit).
template <class T>
inline T non_windup(const T& slope, const T& out, const T& least, const T& most) {
  const T zero(0.0), one(1.0), per_band(1.0 / kIntegralBand);
  const T rise = one - clamp((out - most) * per_band, zero, one);
  const T fall = one - clamp((least - out) * per_band, zero, one);
  return slope * select(slope > zero, rise, fall);  // one derivative also where it is zero
}

}  // namespace swingbank::sim::effects::shared
