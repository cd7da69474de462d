#pragma once
// Common blocks of converter controls: dead-band with two edges, non-windup PI regulator, voltage dip
// detection, lower bound of a voltage used as a divisor.
#include "sim/core/blocks.hpp"
#include "sim/core/literature.hpp"
#include "sim/effects/detail/limited_integral.hpp"

namespace swingbank::sim::effects::renewable {

inline constexpr double kSmallVoltage = 0.01;  ///< lower bound of divisors (WECC's models) [pu]
inline constexpr double kDipBand = 2e-3;  ///< width below Vdip and above Vup over which a dip sets in [pu]
inline constexpr double kNoLimit = 1e6;   ///< limit that never acts [pu]

inline constexpr Source kWecc = literature::own(
    "sign required by the equations; wider than the values of WECC's guides and the case files; 99 and "
    "999: no limit");
inline constexpr Source kFlag = literature::derived("the defined codes");
inline constexpr Source kBus = literature::psse("bus numbers, up to 999997; 0: the unit's own terminal");

/// Returns the signed distance of u from the nearer edge of a dead-band, and 0 between the edges. An edge of
/// the wrong sign counts as 0.
template <class T>
T dead_zone(const T& u, const T& below, const T& above) {
  return positive_part(u - positive_part(above)) - positive_part(T(0.0) - positive_part(T(0.0) - below) - u);
}

/// Returns the limited output of Kp + Ki/s; `runs`: 1, or 0 while the integral is frozen.
template <class T>
T regulator(const T& kp, const T& ki, const T& u, const T& least, const T& most, const T& runs, const T& x,
            T& dx) {
  const T out = kp * u + x;
  dx = runs * shared::non_windup(ki * u, out, least, most);
  return clamp(out, least, most);
}

/// Returns 1 in a voltage dip (below Vdip or above Vup), else 0, with a linear transition over kDipBand.
/// Within the transition, a control whose own action ends the dip can reach an equilibrium.
template <class T>
T voltage_dip(const T& V, const T& vdip, const T& vup) {
  const T zero(0.0), one(1.0), per_band(1.0 / kDipBand);
  return clamp((vdip - V) * per_band, zero, one) + clamp((V - vup) * per_band, zero, one);
}

inline constexpr double kFollow = 2e-3;  ///< time constant for setting timers and tracking stored values [s]
inline constexpr double kFading = 1e-3;  ///< time over which the output of a timer changes [s]
/// Timer after a dip: its state x is set to `whole` [s] during the dip and then decreases to 0. Returns 1
/// while x decreases, else 0.
template <class T>
T timer(const T& dip, const T& whole, const T& x, T& dx) {
  const T zero(0.0), one(1.0);
  dx = dip * (whole - x) * T(1.0 / kFollow) - (one - dip);  // after the dip, x decreases to its lower limit
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

/// Identity, for electrical controls that store no value after a dip.
inline constexpr auto as_it_is = [](const auto& given) { return given; };

/// Returns the remaining limit of one current, sqrt(most^2 - used^2) [pu]; the small minimum keeps its
/// derivative finite.
template <class T>
T other_current(const T& most, const T& used) {
  using std::sqrt;
  const T square = most * most - used * used, tiny(1e-12);
  return sqrt(select(square > tiny, square, tiny));
}

/// Number of coefficients of a voltage-dependent limit with N points: N voltages, the first current, N - 1
/// slopes, the largest current.
template <int N = 4>
inline constexpr int kByVoltage = 2 * N + 1;
/// Computes these coefficients from N points V, I, V, I, ..., used as long as the voltages rise; beyond the
/// last point the current is constant. If the voltages do not rise at all, the only limit is `most`.
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
