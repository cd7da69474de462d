#pragma once
// What is imposed at given times: the shapes the disturbance drives are made of. Their instants must be named
// by instants(); up to the first one a drive adds exactly nothing, because effects never see a later time
// (kBeforeSwitching).
#include "sim/core/scalar.hpp"

namespace swingbank::sim {

/// `value` from t = start on, 0 before.
template <class T>
inline T from(const T& t, const T& start, const T& value) {
  return select(t < start, T(0.0), value);
}
/// `value` from t = start on until just before t = end.
template <class T>
inline T between(const T& t, const T& start, const T& end, const T& value) {
  return select(t < end, from(t, start, value), T(0.0));
}
/// From 0 at t = start in a straight line to 1 at t = start + duration; duration 0: a step.
template <class T>
inline T ramp(const T& t, const T& start, const T& duration) {
  const auto sloped = duration > T(0.0);
  const T along = (t - start) / select(sloped, duration, T(1.0));
  return from(t, start, select(sloped, select(along < T(1.0), along, T(1.0)), T(1.0)));
}

}  // namespace swingbank::sim
