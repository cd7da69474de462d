#pragma once
// What the controls of converters have in common: the dead-band with two edges, the regulator whose integral
// stops at the limits of its output, the voltage dip, the lower bound of a voltage that divides.
#include "sim/core/blocks.hpp"
#include "sim/core/literature.hpp"
#include "sim/effects/detail/limited_integral.hpp"

namespace swingbank::sim::effects::renewable {

inline constexpr double kSmallVoltage = 0.01;  ///< no division by less (WECC's models) [pu]
inline constexpr double kDipBand = 2e-3;       ///< below Vdip and above Vup, where a dip is full [pu]
inline constexpr double kNoLimit = 1e6;        ///< [pu]

inline constexpr Source kWecc = literature::own(
    "the sign the equations need; at the far end beyond what WECC's guides and the case files give, or 99 and "
    "999 (none)");
inline constexpr Source kFlag = literature::derived("the codes there are");
inline constexpr Source kBus = literature::psse("bus numbers, up to 999997; 0: the unit's own terminal");

/// Nothing between the edges, beyond them the distance; an edge on the wrong side of 0 is 0.
template <class T>
T dead_zone(const T& u, const T& below, const T& above) {
  return positive_part(u - positive_part(above)) - positive_part(T(0.0) - positive_part(T(0.0) - below) - u);
}

/// Kp + Ki/s with its output limited; `runs`: 1, or 0 while it is frozen.
template <class T>
T regulator(const T& kp, const T& ki, const T& u, const T& least, const T& most, const T& runs, const T& x,
            T& dx) {
  const T out = kp * u + x;
  dx = runs * shared::non_windup(ki * u, out, least, most);
  return clamp(out, least, most);
}

/// 1 in a voltage dip (below Vdip or above Vup), else 0; in between over kDipBand, so that a control that
/// ends its own dip finds a rest.
template <class T>
T voltage_dip(const T& V, const T& vdip, const T& vup) {
  const T zero(0.0), one(1.0), per_band(1.0 / kDipBand);
  return clamp((vdip - V) * per_band, zero, one) + clamp((V - vup) * per_band, zero, one);
}

inline constexpr double kFollow = 2e-3;  ///< in which timers are set and what is to be kept is followed [s]
inline constexpr double kFading = 1e-3;  ///< over which what is kept after a dip fades [s]
/// A timer's state, set to `whole` in a dip, runs down to 0 after it; returns 1 while it runs after the dip.
template <class T>
T timer(const T& dip, const T& whole, const T& x, T& dx) {
  const T zero(0.0), one(1.0);
  dx = dip * (whole - x) * T(1.0 / kFollow) - (one - dip);  // to the state's lower limit
  return (one - dip) * clamp(x * T(1.0 / kFading), zero, one);
}

template <class T>
T at_least_small(const T& V) {
  return select(V > T(kSmallVoltage), V, T(kSmallVoltage));
}
template <class T>
T smaller(const T& a, const T& b) {
  return select(a < b, a, b);
}
template <class T>
T larger(const T& a, const T& b) {
  return select(a < b, b, a);
}

/// Where an electrical control keeps nothing over: what it is given.
inline constexpr auto as_it_is = [](const auto& given) { return given; };

/// What is left for one current beside the other within Imax; a dual needs a slope where nothing is left.
template <class T>
T other_current(const T& most, const T& used) {
  using std::sqrt;
  const T square = most * most - used * used, tiny(1e-12);
  return sqrt(select(square > tiny, square, tiny));
}

/// Coefficients of a limit by voltage of N points: N voltages, the first current, N - 1 slopes, the largest
/// current.
template <int N = 4>
inline constexpr int kByVoltage = 2 * N + 1;
/// Of the N points V, I, V, I, ... as far as the voltages rise; the current of the last one goes on. Points
/// that do not rise at all are no limit beside `most`.
template <int N = 4, class T>
void prepare_by_voltage(const T* points, const T& most, T* c) {
  const bool any = value_of(points[2]) > value_of(points[0]);
  bool rises = any;
  c[N] = any ? points[1] : most;
  for (int k = 0; k < N; ++k) c[k] = points[2 * k];
  for (int k = 0; k < N - 1; ++k) {
    const T width = points[2 * k + 2] - points[2 * k];
    rises = rises && value_of(width) > 0.0;
    c[N + 1 + k] = rises ? (points[2 * k + 3] - points[2 * k + 1]) / width : T(0.0);
    if (!rises) c[k + 1] = c[k];
  }
  c[2 * N] = most;
}
template <int N = 4, class T>
T by_voltage(const T* c, const T& V) {
  T current = c[N];
  for (int k = 0; k < N - 1; ++k) current = current + c[N + 1 + k] * (clamp(V, c[k], c[k + 1]) - c[k]);
  return smaller(current, c[2 * N]);
}

}  // namespace swingbank::sim::effects::renewable
