#pragma once
// Time functions of disturbances: step, pulse and ramp. An effect that uses them must declare each start and
// end in switching_times(). Before its start, each function returns exactly 0. Integrators evaluate the
// segment before a start only at times before it (`kBeforeSwitching`).
#include "sim/core/scalar.hpp"

namespace swingbank::sim {

/// Step: `value` from t = start on, 0 before.
template <class T>
inline T from(const T& t, const T& start, const T& value) {
  return select(t < start, T(0.0), value);
}
/// Pulse: `value` for start <= t < end, else 0.
template <class T>
inline T between(const T& t, const T& start, const T& end, const T& value) {
  return select(t < end, from(t, start, value), T(0.0));
}
/// Ramp from 0 at t = start to 1 at t = start + duration; duration 0 gives a step.
template <class T>
inline T ramp(const T& t, const T& start, const T& duration) {
  const auto sloped = duration > T(0.0);
  const T along = (t - start) / select(sloped, duration, T(1.0));
  return from(t, start, select(sloped, select(along < T(1.0), along, T(1.0)), T(1.0)));
}

}  // namespace swingbank::sim
