#pragma once
// Common part of steps and ramps of a set-point. A Model defines the moved signal, moved(signals), and the
// size by its first parameter `amount`.
#include <fmt/format.h>

#include <algorithm>

#include "sim/core/disturbance.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::shared {

struct SetpointMove {
  static constexpr std::string_view source = "a disturbance defined by its shape";
  static constexpr Source defaults_from = kNothing;
  static constexpr Slot slot = Slot::setpoint;

  static void check_start(double start, const std::string& where, Problems& problems) {
    if (!(start >= 0))
      problems.add(fmt::format("start = {:g} s", start), where, "a run begins at 0 s", "give start >= 0");
  }

  template <class T>
  static std::string steady(const T*, T*, Signals<T>&, T*) {
    return {};
  }
};

/// Step of `amount` from start to end [s], end excluded.
template <class Model>
struct SetpointStep : SetpointMove {
  enum P { amount, start, end };
  static constexpr Parameter kStart = {
      "start", "t1", "s", 1.0, 0.0, 1e5, kNoNullValue, "start of the step", kAfterRest, kAnyTime};
  static constexpr Parameter kEnd = {
      "end", "t2", "s", 1e5, 0.0, 1e5, kNoNullValue, "end of the step (100000: never)", kNever, kAnyTime};
  enum C { coefficients = end + 1 };

  static void check(const double* p, const std::string& where, Problems& problems) {
    check_start(p[start], where, problems);
    if (!(p[end] > p[start]))
      problems.add(fmt::format("end = {:g} s with start = {:g} s", p[end], p[start]), where,
                   "a step ends after its start", "give end > start");
  }
  static std::vector<double> switching_times(const double* p) { return {p[start], p[end]}; }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    std::copy(p, p + coefficients, c);
  }
  template <class T>
  static void evaluate(const T* c, const T*, Signals<T>& s, T*) {
    T& setpoint = Model::moved(s);
    setpoint = setpoint + between(s.t, c[start], c[end], c[amount]);
  }
};

/// Linear ramp from 0 at start to `amount` at start + duration [s], constant afterwards.
template <class Model>
struct SetpointRamp : SetpointMove {
  enum P { amount, start, duration };
  static constexpr Parameter kStart = {
      "start", "t1", "s", 1.0, 0.0, 1e5, kNoNullValue, "start of the ramp", kAfterRest, kAnyTime};
  static constexpr Parameter kDuration = {
      "duration",  "T",     "s", 5.0, 0.0, 1e5, kNoNullValue, "duration of the ramp (0: a step)",
      kFewSeconds, kAnyTime};
  enum C { coefficients = duration + 1 };

  static void check(const double* p, const std::string& where, Problems& problems) {
    check_start(p[start], where, problems);
    if (!(p[duration] >= 0))
      problems.add(fmt::format("duration = {:g} s", p[duration]), where, "a duration cannot be negative",
                   "give duration >= 0");
  }
  static std::vector<double> switching_times(const double* p) { return {p[start], p[start] + p[duration]}; }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    std::copy(p, p + coefficients, c);
  }
  template <class T>
  static void evaluate(const T* c, const T*, Signals<T>& s, T*) {
    T& setpoint = Model::moved(s);
    setpoint = setpoint + c[amount] * ramp(s.t, c[start], c[duration]);
  }
};

}  // namespace swingbank::sim::effects::shared
