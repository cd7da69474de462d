#pragma once
// The curve from a gate's or valve's opening to power or flow, through points given in ascending order.
// Points not used are zero; with fewer than two the output is the opening. Beyond the ends the curve goes on
// straight.
#include <fmt/format.h>

#include "sim/core/effect.hpp"

namespace swingbank::sim::effects::shared {

/// How fast a gate or valve behind a backlash follows beyond it [1/s]: fast beside its servo.
inline constexpr double kFollowRate = 50.0;

/// Through `count` points: a Model keeps `size` coefficients from `first` on.
template <int count>
struct GatePower {
  static constexpr int segments = count - 1;
  /// Of each segment: where it begins, what it begins with, its width, its slope and the slope's reciprocal.
  enum { begin, base = begin + segments, width = base + segments, slope = width + segments };
  static constexpr int flat = slope + segments, size = flat + segments;

  /// The points as (opening, power), each given by its index in p.
  template <class T>
  static void prepare(const T* p, const int (&gate)[count], const int (&power)[count], T* c) {
    const T zero(0.0), one(1.0), far(1e9);
    for (int k = 0; k < segments; ++k) {
      const T run = p[gate[k + 1]] - p[gate[k]], rise = p[power[k + 1]] - p[power[k]];
      const auto used = run > zero;
      const T divisor = select(used, run, one), steep = select(rise > zero, rise, one);
      const T unused_slope = T(k == 0 ? 1.0 : 0.0);  // a curve without points is the opening itself
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
  /// The opening that gives this power.
  template <class T>
  static T opening(const T* c, const T& power) {
    return along(c, power, base, c[begin], flat, true);
  }

  /// What is wrong with the points.
  template <class Text>
  static void check(const double* p, const int (&gate)[count], const int (&power)[count], const Text& text,
                    const std::string& where, Problems& problems) {
    bool over = false;
    for (int k = 0; k < segments; ++k) {
      const double run = p[gate[k + 1]] - p[gate[k]], rise = p[power[k + 1]] - p[power[k]];
      if (over ? p[gate[k + 1]] != 0.0 || p[power[k + 1]] != 0.0 : run > 0.0 && !(rise > 0.0))
        problems.add(text(gate[k + 1]) + " with " + text(power[k + 1]), where,
                     over ? "a point follows the end of the curve" : "more opening must give more",
                     "give points in ascending order, those that are not used as 0");
      over = over || !(run > 0.0);
    }
  }

 private:
  /// From `first` on, the rates times what lies within each segment; `inverse`: widths are those of the rise.
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
