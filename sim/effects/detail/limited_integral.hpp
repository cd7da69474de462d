#pragma once
// Non-windup integral of a PI regulator: while the regulator's output is beyond a limit, the integral changes
// only back towards the limit.
#include "sim/core/scalar.hpp"

namespace swingbank::sim::effects::shared {

inline constexpr double kIntegralBand = 2e-3;  ///< width of the transition beyond a limit [pu]

/// Returns the derivative of a PI's integral. It is zero while the unlimited output `out` is beyond a limit
/// and `derivative` would move it further out, else `derivative`. The transition is linear over
/// kIntegralBand. With a discontinuous transition there is no solution if the proportional part falls while
/// the integral rises (sliding along the limit).
template <class T>
inline T non_windup(const T& derivative, const T& out, const T& least, const T& most) {
  const T zero(0.0), one(1.0), per_band(1.0 / kIntegralBand);
  const T rise = one - clamp((out - most) * per_band, zero, one);
  const T fall = one - clamp((least - out) * per_band, zero, one);
  return derivative * select(derivative > zero, rise, fall);  // differentiable also at zero
}

}  // namespace swingbank::sim::effects::shared
