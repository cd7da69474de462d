#pragma once
// Timers as states: what has lasted for its delay, and what stays so for good once it has.
#include "sim/effects/detail/renewable.hpp"

namespace swingbank::sim::effects::shared {

/// A timer that runs while `beyond` is 1 and returns to 0 where that ends before `delay`; 1 for good once
/// it has gone past it, where nothing moves it back.
template <class T>
T passed(const T& beyond, const T& delay, const T& x, T& dx) {
  const T zero(0.0), one(1.0), past = (x - delay) * T(1.0 / renewable::kFading);
  const T kept = clamp(past, zero, one);
  dx = beyond * clamp(T(2.0) - past, zero, one) -
       (one - kept) * (one - beyond) * x * T(1.0 / renewable::kFollow);
  return kept;
}

/// The same, but it returns to 0 where `beyond` ends, whenever that is.
template <class T>
T lasting(const T& beyond, const T& delay, const T& x, T& dx) {
  const T zero(0.0), one(1.0), past = (x - delay) * T(1.0 / renewable::kFading);
  dx = beyond * clamp(T(2.0) - past, zero, one) - (one - beyond) * x * T(1.0 / renewable::kFollow);
  return clamp(past, zero, one);
}

}  // namespace swingbank::sim::effects::shared
