#pragma once
// Dual<N>: a value and its derivatives with respect to N parameters (forward-mode automatic differentiation).
#include <cmath>

#include "sim/core/pack.hpp"

namespace swingbank::sim {

/// Returns `m ? a : b`; the counterpart of select() for SIMD batches.
inline double select(bool m, double a, double b) { return m ? a : b; }

/// Value with its gradient with respect to N parameters; operators apply the sum, product and quotient rules.
/// Comparisons use the value alone.
template <int N>
struct Dual {
  Pack<N> d{0.0};  ///< derivatives of the value with respect to the N parameters
  double a = 0.0;  ///< value
  Dual() = default;
  /// Constructs a constant: all derivatives are zero.
  Dual(double x) : a(x) {}
  /// Constructs a value with its derivatives.
  Dual(double x, Pack<N> derivatives) : d(derivatives), a(x) {}

  /// Returns the sum.
  friend Dual operator+(const Dual& x, const Dual& y) { return {x.a + y.a, x.d + y.d}; }
  /// Returns the difference.
  friend Dual operator-(const Dual& x, const Dual& y) { return {x.a - y.a, x.d - y.d}; }
  /// Returns the product.
  friend Dual operator*(const Dual& x, const Dual& y) { return {x.a * y.a, x.d * y.a + x.a * y.d}; }
  /// Returns the quotient.
  friend Dual operator/(const Dual& x, const Dual& y) {
    const double inverse = 1.0 / y.a, quotient = x.a * inverse;
    return {quotient, (x.d - quotient * y.d) * inverse};
  }
  friend Dual operator-(const Dual& x) { return Dual(0.0) - x; }               ///< negation
  friend bool operator<(const Dual& x, const Dual& y) { return x.a < y.a; }    ///< compares values
  friend bool operator>(const Dual& x, const Dual& y) { return x.a > y.a; }    ///< compares values
  friend bool operator<=(const Dual& x, const Dual& y) { return x.a <= y.a; }  ///< compares values
};

/// Returns the dual of f(x) from f(x) and `derivative` = f'(x) by the chain rule.
template <int N>
inline Dual<N> chain(const Dual<N>& x, double f, double derivative) {
  return {f, derivative * x.d};
}

/// Returns x if m is true, else y, with the derivatives.
template <int N>
inline Dual<N> select(bool m, const Dual<N>& x, const Dual<N>& y) {
  return m ? x : y;
}

}  // namespace swingbank::sim
