#pragma once
// Dual<T, N>: a value and its derivatives with respect to N parameters (forward-mode automatic
// differentiation). T is double.
#include <array>
#include <cmath>

namespace swingbank::sim {

/// Returns `m ? a : b`; the counterpart of select() for SIMD batches.
inline double select(bool m, double a, double b) { return m ? a : b; }

/// Value with its gradient with respect to N parameters; operators apply the sum, product and quotient rules.
/// Comparisons use the value alone.
template <class T, int N>
struct Dual {
  T a{};                 ///< value
  std::array<T, N> d{};  ///< derivatives of the value with respect to the N parameters
  Dual() = default;
  /// Constructs a constant: all derivatives are zero.
  Dual(double x) : a(x) { d.fill(T(0.0)); }

  /// Returns the sum.
  friend Dual operator+(const Dual& x, const Dual& y) {
    Dual r;
    r.a = x.a + y.a;
    for (int i = 0; i < N; ++i) r.d[i] = x.d[i] + y.d[i];
    return r;
  }
  /// Returns the difference.
  friend Dual operator-(const Dual& x, const Dual& y) {
    Dual r;
    r.a = x.a - y.a;
    for (int i = 0; i < N; ++i) r.d[i] = x.d[i] - y.d[i];
    return r;
  }
  /// Returns the product.
  friend Dual operator*(const Dual& x, const Dual& y) {
    Dual r;
    r.a = x.a * y.a;
    for (int i = 0; i < N; ++i) r.d[i] = x.d[i] * y.a + x.a * y.d[i];
    return r;
  }
  /// Returns the quotient.
  friend Dual operator/(const Dual& x, const Dual& y) {
    Dual r;
    const T inverse = T(1.0) / y.a;
    r.a = x.a * inverse;
    for (int i = 0; i < N; ++i) r.d[i] = (x.d[i] - r.a * y.d[i]) * inverse;
    return r;
  }
  friend Dual operator-(const Dual& x) { return Dual(0.0) - x; }               ///< negation
  friend auto operator<(const Dual& x, const Dual& y) { return x.a < y.a; }    ///< compares values
  friend auto operator>(const Dual& x, const Dual& y) { return x.a > y.a; }    ///< compares values
  friend auto operator<=(const Dual& x, const Dual& y) { return x.a <= y.a; }  ///< compares values
};

/// Returns the dual of f(x) from f(x) and `derivative` = f'(x) by the chain rule.
template <class T, int N>
inline Dual<T, N> chain(const Dual<T, N>& x, const T& f, const T& derivative) {
  Dual<T, N> r;
  r.a = f;
  for (int i = 0; i < N; ++i) r.d[i] = derivative * x.d[i];
  return r;
}

/// Returns x where m holds, else y, with the derivatives.
template <class M, class T, int N>
inline Dual<T, N> select(const M& m, const Dual<T, N>& x, const Dual<T, N>& y) {
  Dual<T, N> r;
  r.a = select(m, x.a, y.a);
  for (int i = 0; i < N; ++i) r.d[i] = select(m, x.d[i], y.d[i]);
  return r;
}

}  // namespace swingbank::sim
