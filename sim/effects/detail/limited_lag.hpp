#pragma once
// Lag with variable limits: a state beyond a limit is driven back to it, which prevents windup.
#include "sim/core/blocks.hpp"

namespace swingbank::sim::effects::shared {

/// Rate of the return to a limit [1/s]: faster than the limited lags with their default time constants (at
/// least 4 ms), slow enough for integration.
inline constexpr double kReturn = 500.0;

/// Returns the output of 1/(1 + sT) with the limits `least` and `most`; T = 0 passes the limited input.
template <class T>
T limited_lag(const T& inverse_T, const T& x, const T& u, const T& least, const T& most, T& dx) {
  const T within = clamp(lag(inverse_T, x, u, dx), least, most);
  dx = select(inverse_T > T(0.0), dx - T(kReturn) * (x - within), T(0.0));
  return within;
}

}  // namespace swingbank::sim::effects::shared
