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
using D8 = Dual<double, kSensitivities>;  ///< double with sensitivities
using P4 = Pack<4>;                       ///< four doubles
using P8 = Pack<8>;                       ///< eight doubles

/// Scalar types for which all equations of an effect are instantiated. New types are added only here.
/// FloatPack is separate (float_ops.hpp).
using Scalars = std::tuple<double, P4, P8, D8>;

/// Computes sine and cosine of a [rad].
inline void sincos(double a, double& s, double& c) {
  s = std::sin(a);
  c = std::cos(a);
}
/// Computes sine and cosine of a [rad], with derivatives.
template <class T, int N>
inline void sincos(const Dual<T, N>& a, Dual<T, N>& s, Dual<T, N>& c) {
  T sa, ca;
  sincos(a.a, sa, ca);
  s = chain(a, sa, ca);
  c = chain(a, ca, T(0.0) - sa);
}
/// Returns the square root, with derivatives.
template <class T, int N>
inline Dual<T, N> sqrt(const Dual<T, N>& a) {
  using std::sqrt;
  const T f = sqrt(a.a);
  return chain(a, f, T(0.5) / f);
}
/// Returns the four-quadrant arctangent [rad], with derivatives.
template <class T, int N>
inline Dual<T, N> atan2(const Dual<T, N>& y, const Dual<T, N>& x) {
  using std::atan2;
  Dual<T, N> r;
  r.a = atan2(y.a, x.a);
  const T q = T(1.0) / (x.a * x.a + y.a * y.a);
  for (int i = 0; i < N; ++i) r.d[i] = (x.a * y.d[i] - y.a * x.d[i]) * q;
  return r;
}
/// Returns the exponential, with derivatives.
template <class T, int N>
inline Dual<T, N> exp(const Dual<T, N>& a) {
  using std::exp;
  const T f = exp(a.a);
  return chain(a, f, f);
}
/// Returns the natural logarithm, with derivatives.
template <class T, int N>
inline Dual<T, N> log(const Dual<T, N>& a) {
  using std::log;
  return chain(a, log(a.a), T(1.0) / a.a);
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
template <class T, int N>
inline double value_of(const Dual<T, N>& a) {
  return value_of(a.a);
}

/// Whether any lane is above zero. Equations use it to skip a term that is zero in every lane.
inline bool any_positive(double a) { return a > 0.0; }
/// Whether the value of any lane is above zero.
template <class T, int N>
inline bool any_positive(const Dual<T, N>& a) {
  return any_positive(a.a);
}

}  // namespace swingbank::sim
