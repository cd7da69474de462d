#pragma once
// The elements control diagrams are drawn with. A time constant of zero is a bypass, as in PSS/E: `inverse`
// turns it into the mark 0 that every element understands. Each function returns the output and writes the
// derivative of its state; a non-windup limit is declared with the state (see State::low) and repeated here
// by clamp() where the output must not see the overshoot of a trial step.
#include "sim/core/scalar.hpp"

namespace swingbank::sim {

/// 1/T, or 0 for T = 0 (bypass).
template <class T>
inline T inverse(const T& time_constant) {
  const auto on = time_constant > T(0.0);
  return select(on, T(1.0) / select(on, time_constant, T(1.0)), T(0.0));
}

/// 1/(1 + sT): the state is the output; T = 0 passes the input.
template <class T>
inline T lag(const T& inverse_T, const T& x, const T& u, T& dx) {
  dx = (u - x) * inverse_T;
  return select(inverse_T > T(0.0), x, u);
}

/// (1 + s Ta)/(1 + s Tb): the state is the lagged input; Tb = 0 passes the input (Ta is then without
/// meaning).
template <class T>
inline T lead_lag(const T& Ta, const T& inverse_Tb, const T& x, const T& u, T& dx) {
  dx = (u - x) * inverse_Tb;
  return select(inverse_Tb > T(0.0), x + Ta * dx, u);
}

/// sT/(1 + sT): the state is the lagged input; T = 0 blocks everything, as the limit does.
template <class T>
inline T washout(const T& inverse_T, const T& x, const T& u, T& dx) {
  dx = (u - x) * inverse_T;
  return select(inverse_T > T(0.0), u - x, T(0.0));
}

/// Nothing within +-width, beyond it the distance to the edge (no step: IEEE Std 421.5 type 2).
template <class T>
inline T dead_band(const T& u, const T& width) {
  return positive_part(u - width) - positive_part(T(0.0) - u - width);
}

/// Exciter saturation V Se(V) = B (V - A)^2 above A through two points (PSS/E: E1, SE(E1), E2, SE(E2)).
/// Both factors zero: none.
template <class T>
struct Quadratic {
  T A{}, B{};
  static Quadratic through(const T& ea, const T& sa, const T& eb, const T& sb) {
    using std::sqrt;
    const auto swapped = eb < ea;  // either order occurs in files
    const T e1 = select(swapped, eb, ea), s1 = select(swapped, sb, sa);
    const T e2 = select(swapped, ea, eb), s2 = select(swapped, sa, sb);
    const auto on = s2 * e2 > s1 * e1;
    const T low = select(on, s1 * e1, T(0.0)), high = select(on, s2 * e2, T(1.0));
    const auto curved = low > T(0.0);
    const T r = select(curved, sqrt(select(curved, low, T(1.0)) / high), T(0.0));
    const T a = (e1 - r * e2) / (T(1.0) - r);
    Quadratic q;
    q.A = select(on, a, T(0.0));
    q.B = select(on, high / square(select(on, e2 - a, T(1.0))), T(0.0));
    return q;
  }
  /// V Se(V): what saturation takes from the exciter's input.
  [[nodiscard]] T operator()(const T& v) const { return B * square(positive_part(v - A)); }
};

/// What a three-phase bridge rectifier delivers from the voltage V behind its commutating reactance, loaded
/// with I = KC Ifd [pu]: V FEX(I/V), FEX of IEEE Std 421.5, annex D, multiplied out so that nothing divides.
template <class T>
inline T rectified(const T& V, const T& I) {
  using std::sqrt;
  const T root3(1.7320508075688772), zero(0.0);
  const T square_2 = T(0.75) * V * V - I * I;
  const auto mode1 = T(4.0) * I <= root3 * V, mode2 = T(4.0) * I <= T(3.0) * V;
  const T arc = sqrt(select(square_2 > zero, square_2, T(1.0)));
  return select(mode1, V - positive_part(I) / root3, select(mode2, arc, root3 * positive_part(V - I)));
}
/// The V from which a rectifier loaded with I delivers Efd > 0.
template <class T>
inline T rectifier_source(const T& Efd, const T& I) {
  using std::sqrt;
  const T root3(1.7320508075688772);
  const T arc = sqrt((Efd * Efd + I * I) / T(0.75));
  return select(root3 * I <= Efd, Efd + positive_part(I) / root3,
                select(I <= root3 * Efd, arc, I + Efd / root3));
}

}  // namespace swingbank::sim
