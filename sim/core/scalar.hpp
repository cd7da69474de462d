#pragma once
// Scalar types of the equations, and the functions that equations may apply to them: + - * / < > <=, select,
// sqrt, exp, log, sincos, atan2 (only in steady()), square, magnitude, squared_magnitude, positive_part,
// clamp, any_positive, value_of (only in messages and conditions).
#include <cmath>
#include <tuple>

#include "sim/core/dual.hpp"
#include "sim/core/pack.hpp"

namespace swingbank::sim {

/// Number of sensitivity parameters of a dual number.
constexpr int kSensitivities = 8;
using D8 = Dual<kSensitivities>;  ///< double with sensitivities
using P4 = Pack<4>;               ///< four doubles
using P8 = Pack<8>;               ///< eight doubles

/// Scalar types for which all equations of an effect are instantiated. New types are added only here.
/// FloatPack is separate (float_ops.hpp).
using Scalars = std::tuple<double, P4, P8, D8>;

/// Computes sine and cosine of a [rad].
inline void sincos(double a, double& s, double& c) {
  s = std::sin(a);
  c = std::cos(a);
}
/// Computes sine and cosine of a [rad], with derivatives.
template <int N>
inline void sincos(const Dual<N>& a, Dual<N>& s, Dual<N>& c) {
  double sa, ca;
  sincos(a.a, sa, ca);
  s = chain(a, sa, ca);
  c = chain(a, ca, -sa);
}
/// Returns the square root, with derivatives.
template <int N>
inline Dual<N> sqrt(const Dual<N>& a) {
  const double f = std::sqrt(a.a);
  return chain(a, f, 0.5 / f);
}
/// Returns the four-quadrant arctangent [rad], with derivatives.
template <int N>
inline Dual<N> atan2(const Dual<N>& y, const Dual<N>& x) {
  const double q = 1.0 / (x.a * x.a + y.a * y.a);
  return {std::atan2(y.a, x.a), (x.a * y.d - y.a * x.d) * q};
}
/// Returns the exponential, with derivatives.
template <int N>
inline Dual<N> exp(const Dual<N>& a) {
  const double f = std::exp(a.a);
  return chain(a, f, f);
}
/// Returns the natural logarithm, with derivatives.
template <int N>
inline Dual<N> log(const Dual<N>& a) {
  return chain(a, std::log(a.a), 1.0 / a.a);
}
/// Returns a^2.
template <class T>
inline T square(const T& a) {
  return a * a;
}
/// Returns |re + j im|^2. The added 1e-24 keeps the derivative of the magnitude finite at 0.
template <class T>
inline T squared_magnitude(const T& re, const T& im) {
  return re * re + im * im + T(1e-24);
}
/// Returns |re + j im|.
template <class T>
inline T magnitude(const T& re, const T& im) {
  using std::sqrt;
  return sqrt(squared_magnitude(re, im));
}
/// Returns max(a, 0).
template <class T>
inline T positive_part(const T& a) {
  return select(a > T(0.0), a, T(0.0));
}
/// Returns a, limited to low ... high.
template <class T>
inline T clamp(const T& a, const T& low, const T& high) {
  return select(a < low, low, select(high < a, high, a));
}

/// Returns the plain value of any scalar (lane 0 of a pack). Equations may use it only in messages and in
/// conditions of code that runs in double or in dual numbers.
inline double value_of(double a) { return a; }
/// Returns the value of the first lane.
template <class S, int N>
inline double value_of(const Packed<S, N>& a) {
  return a[0];
}
/// Returns the value without its derivatives.
template <int N>
inline double value_of(const Dual<N>& a) {
  return a.a;
}

/// Whether any lane is above zero. Equations use it to skip a term that is zero in every lane.
inline bool any_positive(double a) { return a > 0.0; }
/// Whether the value of any lane is above zero.
template <int N>
inline bool any_positive(const Dual<N>& a) {
  return a.a > 0.0;
}

}  // namespace swingbank::sim
