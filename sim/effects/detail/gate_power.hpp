#pragma once
// Piecewise linear curve from the opening of a gate or valve to power or flow. Its points are in ascending
// order; unused points are zero. With fewer than two points the output is the opening. The curve is
// extrapolated linearly beyond its ends.

#include "sim/core/effect.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::shared {

/// Rate at which the position behind a backlash follows the gate or valve [1/s]; fast compared with the
/// servo.
inline constexpr double kFollowRate = 50.0;

/// Curve through `count` points; a Model has `size` coefficients for it.
template <int count>
struct GatePower {
  static constexpr int segments = count - 1;
  /// For each segment: opening and power at its beginning, its width, its slope and the reciprocal slope.
  enum { begin, base = begin + segments, width = base + segments, slope = width + segments };
  static constexpr int flat = slope + segments, size = flat + segments;

  /// Computes the coefficients; the points are (opening, power), given by their indices in p.
  template <class T>
  static void prepare(const T* p, const int (&gate)[count], const int (&power)[count], T* c) {
    const T zero(0.0), one(1.0), far(1e9);
    for (int k = 0; k < segments; ++k) {
      const T run = p[gate[k + 1]] - p[gate[k]], rise = p[power[k + 1]] - p[power[k]];
      const auto used = run > zero;
      const T divisor = select(used, run, one), steep = select(rise > zero, rise, one);
      const T unused_slope = T(k == 0 ? 1.0 : 0.0);  // without points the output is the opening
      c[begin + k] = select(used, p[gate[k]], k == 0 ? zero : far);
      c[base + k] = select(used, p[power[k]], k == 0 ? zero : far);
      c[slope + k] = select(used, rise / divisor, unused_slope);
      c[flat + k] = select(used, run / steep, unused_slope);
      const auto last = k + 2 < count ? p[gate[k + 2 < count ? k + 2 : k]] > p[gate[k + 1]] : one < zero;
      c[width + k] = select(last, run, far);
    }
  }
  template <class T>
  static T value(const T* c, const T& opening) {
    return along(c, opening, begin, c[base], slope, false);
  }
  /// Returns the opening for a given power [pu].
  template <class T>
  static T opening(const T* c, const T& power) {
    return along(c, power, base, c[begin], flat, true);
  }

  /// Checks the points.
  static void check(const ValueCheck& values, const double* p, const int (&gate)[count],
                    const int (&power)[count]) {
    bool over = false;
    for (int k = 0; k < segments; ++k) {
      const double run = p[gate[k + 1]] - p[gate[k]], rise = p[power[k + 1]] - p[power[k]];
      const bool wrong = over ? p[gate[k + 1]] != 0.0 || p[power[k + 1]] != 0.0 : run > 0.0 && !(rise > 0.0);
      values.refuse(wrong, values.text(gate[k + 1], power[k + 1]),
                    over ? "a point follows the end of the curve" : "the curve must rise with the opening",
                    "give points in ascending order, unused ones as 0");
      over = over || !(run > 0.0);
    }
  }

 private:
  /// Adds the segments up to `at`, each with its slope, to the value `first`. `inverse`: the independent
  /// variable is the power.
  template <class T>
  static T along(const T* c, const T& at, int from, const T& first, int rate, bool inverse) {
    T sum = first;
    for (int k = 0; k < segments; ++k) {
      const T most = inverse ? c[width + k] * c[slope + k] : c[width + k];
      const T within = at - c[from + k];
      const T lower = k == 0 ? within : positive_part(within);
      sum = sum + c[rate + k] * select(lower < most, lower, most);
    }
    return sum;
  }
};

}  // namespace swingbank::sim::effects::shared
