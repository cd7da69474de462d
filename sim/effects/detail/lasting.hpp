#pragma once
// Timers whose elapsed time is a state variable, with and without latching after the delay.
#include "sim/effects/detail/renewable.hpp"

namespace swingbank::sim::effects::shared {

/// Latching timer: runs while `beyond` is 1 and resets if `beyond` ends before `delay` [s]. Returns 1
/// permanently after the delay, else 0.
template <class T>
T passed(const T& beyond, const T& delay, const T& x, T& dx) {
  const T zero(0.0), one(1.0), past = (x - delay) * T(1.0 / renewable::kFading);
  const T kept = clamp(past, zero, one);
  dx = beyond * clamp(T(2.0) - past, zero, one) -
       (one - kept) * (one - beyond) * x * T(1.0 / renewable::kFollow);
  return kept;
}

/// Non-latching timer: as passed(), but it resets whenever `beyond` ends.
template <class T>
T lasting(const T& beyond, const T& delay, const T& x, T& dx) {
  const T zero(0.0), one(1.0), past = (x - delay) * T(1.0 / renewable::kFading);
  dx = beyond * clamp(T(2.0) - past, zero, one) - (one - beyond) * x * T(1.0 / renewable::kFollow);
  return clamp(past, zero, one);
}

}  // namespace swingbank::sim::effects::shared
