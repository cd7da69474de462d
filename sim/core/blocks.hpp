#pragma once
// Elements of control block diagrams. The function of an element with a state returns the output and writes
// the state's derivative. A time constant of zero is a bypass, as in PSS/E: `inverse` then returns 0, and
// every element treats this value as T = 0. Non-windup limits are declared with the state (`State::low`).
// Where the output must stay within its limits in a trial step too, the caller also applies clamp().
#include "sim/core/scalar.hpp"

namespace swingbank::sim {

/// Returns 1/T [1/s], or 0 for T = 0 (bypass).
template <class T>
inline T inverse(const T& time_constant) {
  const auto on = time_constant > T(0.0);
  return select(on, T(1.0) / select(on, time_constant, T(1.0)), T(0.0));
}

/// First-order lag 1/(1 + sT). The state is the output; T = 0 passes the input.
template <class T>
inline T lag(const T& inverse_T, const T& x, const T& u, T& dx) {
  dx = (u - x) * inverse_T;
  return select(inverse_T > T(0.0), x, u);
}

/// Lead-lag (1 + s Ta)/(1 + s Tb). The state is the lagged input; Tb = 0 passes the input and ignores Ta.
template <class T>
inline T lead_lag(const T& Ta, const T& inverse_Tb, const T& x, const T& u, T& dx) {
  dx = (u - x) * inverse_Tb;
  return select(inverse_Tb > T(0.0), x + Ta * dx, u);
}

/// Washout sT/(1 + sT). The state is the lagged input; T = 0 gives 0, the limit of the transfer function.
template <class T>
inline T washout(const T& inverse_T, const T& x, const T& u, T& dx) {
  dx = (u - x) * inverse_T;
  return select(inverse_T > T(0.0), u - x, T(0.0));
}

/// Dead band without a step (IEEE Std 421.5, type 2): 0 for |u| <= `width`, beyond it the signed distance of
/// u to the nearer edge.
template <class T>
inline T dead_band(const T& u, const T& width) {
  return positive_part(u - width) - positive_part(T(0.0) - u - width);
}

/// Exciter saturation V Se(V) = B (V - A)^2 above A, fitted through two points (PSS/E: E1, SE(E1), E2,
/// SE(E2)). Both factors zero: no saturation.
template <class T>
struct Quadratic {
  T A{}, B{};  ///< A [pu], threshold of V; B [1/pu], 0: no saturation
  /// Returns the curve through the points (ea, sa) and (eb, sb), in either order; Se(V) = S at V = E [pu].
  static Quadratic through(const T& ea, const T& sa, const T& eb, const T& sb) {
    using std::sqrt;
    const auto swapped = eb < ea;  // files give the two points in either order
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
  /// Returns V Se(V) [pu], the saturation term that is subtracted from the exciter's input.
  [[nodiscard]] T operator()(const T& v) const { return B * square(positive_part(v - A)); }
};

/// DC voltage of a three-phase bridge rectifier [pu]: V FEX(I/V) with source voltage V behind the commutating
/// reactance and load I = KC Ifd. FEX is that of IEEE Std 421.5, annex D. Computing the product V FEX avoids
/// the division I/V.
template <class T>
inline T rectified(const T& V, const T& I) {
  using std::sqrt;
  const T root3(1.7320508075688772), zero(0.0);
  const T square_2 = T(0.75) * V * V - I * I;
  const auto mode1 = T(4.0) * I <= root3 * V, mode2 = T(4.0) * I <= T(3.0) * V;
  const T arc = sqrt(select(square_2 > zero, square_2, T(1.0)));
  return select(mode1, V - positive_part(I) / root3, select(mode2, arc, root3 * positive_part(V - I)));
}
/// Returns the source voltage V [pu] at which a rectifier with load I delivers Efd > 0. Inverse of
/// rectified().
template <class T>
inline T rectifier_source(const T& Efd, const T& I) {
  using std::sqrt;
  const T root3(1.7320508075688772);
  const T arc = sqrt((Efd * Efd + I * I) / T(0.75));
  return select(root3 * I <= Efd, Efd + positive_part(I) / root3,
                select(I <= root3 * Efd, arc, I + Efd / root3));
}

}  // namespace swingbank::sim
