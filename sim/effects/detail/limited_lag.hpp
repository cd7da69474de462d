#pragma once
// A lag between limits that move: its state is drawn back to one that it has passed, so that it does not wind
// up.
#include "sim/core/blocks.hpp"

namespace swingbank::sim::effects::shared {

/// How fast [1/s]: fast beside any time constant, slow enough to be integrated.
inline constexpr double kReturn = 500.0;

/// 1/(1 + sT) within `least` and `most`; T = 0 passes the input within them.
template <class T>
T limited_lag(const T& inverse_T, const T& x, const T& u, const T& least, const T& most, T& dx) {
  const T within = clamp(lag(inverse_T, x, u, dx), least, most);
  dx = select(inverse_T > T(0.0), dx - T(kReturn) * (x - within), T(0.0));
  return within;
}

}  // namespace swingbank::sim::effects::shared
