#pragma once
// Saturation of a synchronous machine in PSS/E's form: the factors Se at 1.0 and 1.2 pu flux; S1.0 = 0 means
// no saturation. The field current exceeds that of the air-gap line by psi Se(psi) [pu].
#include <string_view>

#include "sim/core/scalar.hpp"

namespace swingbank::sim {

/// Computes A and B of Se = B (psi - A)^2/psi through S1.0 and S1.2 (PSS/E GENROU, GENSAL). Requires 1.2 S1.2
/// > S1.0; otherwise no such quadratic exists.
template <class T>
inline void quadratic_saturation(const T& s10, const T& s12, T& a, T& b) {
  using std::sqrt;
  const auto on = s10 > T(0.0);
  const T safe = select(on, s10, T(1.0)), top = select(on, s12, T(2.0));
  const T r = sqrt(T(1.2) * top / safe);
  a = select(on, (r - T(1.2)) / (r - T(1.0)), T(0.0));
  b = select(on, s10 / square(T(1.0) - a), T(0.0));
}

/// Returns x of Se = S1.0 psi^x through both factors, x = ln(S1.2/S1.0)/ln 1.2 (PSS/E GENROE, GENSAE).
/// Requires S1.2 > 0.
template <class T>
inline T saturation_exponent(const T& s10, const T& s12) {
  using std::log;
  const auto on = s10 > T(0.0);
  const T ratio = select(on, s12, T(1.0)) / select(on, s10, T(1.0));
  return log(ratio) * T(1.0 / 0.18232155679395462);  // ln 1.2
}
/// Returns Se(psi) from psi^2 [pu^2]; S1.0 = 0 gives 0.
template <class T>
inline T exponential_saturation(const T& s10, const T& exponent, const T& flux_squared) {
  using std::exp;
  using std::log;
  return s10 * exp(exponent * T(0.5) * log(flux_squared + T(1e-24)));
}

/// Quadratic saturation as a template policy of a machine: coefficients `a`, `b`, Se as a function of psi^2,
/// and the test of the two factors. ExponentialSaturation has the same members.
struct QuadraticSaturation {
  /// Reason in the error message for two factors that no such curve fits.
  static constexpr std::string_view impossible =
      "no quadratic saturation curve has these factors S1.0 and S1.2";
  /// Remedy in that message.
  static constexpr std::string_view remedy = "give 1.2 S1.2 > S1.0, or S1.0 = 0 for no saturation";
  /// Whether a quadratic passes through both factors, or there is no saturation (S1.0 = 0).
  static bool possible(double s10, double s12) { return !(s10 > 0) || 1.2 * s12 > s10; }
  /// Computes the coefficients `a` [pu] and `b` [1/pu] from S1.0 and S1.2.
  template <class T>
  static void prepare(const T& s10, const T& s12, T& a, T& b) {
    quadratic_saturation(s10, s12, a, b);
  }
  /// Returns Se(psi) from psi^2 [pu^2].
  template <class T>
  static T factor(const T& a, const T& b, const T& flux_squared) {
    using std::sqrt;
    const T psi = sqrt(flux_squared + T(1e-24));
    return b * square(positive_part(psi - a)) / psi;
  }
};
/// Exponential saturation Se = S1.0 psi^x as a template policy of a machine; coefficients a = S1.0, b = x.
struct ExponentialSaturation {
  /// Reason in the error message for two factors that no such curve fits.
  static constexpr std::string_view impossible =
      "no exponential saturation curve has these factors S1.0 and S1.2";
  /// Remedy in that message.
  static constexpr std::string_view remedy = "give S1.2 > 0, or S1.0 = 0 for no saturation";
  /// Whether a power of the flux passes through both factors, or there is no saturation (S1.0 = 0).
  static bool possible(double s10, double s12) { return !(s10 > 0) || s12 > 0; }
  /// Computes the coefficients a = S1.0 and b = x from S1.0 and S1.2.
  template <class T>
  static void prepare(const T& s10, const T& s12, T& a, T& b) {
    a = s10;
    b = saturation_exponent(s10, s12);
  }
  /// Returns Se(psi) from psi^2 [pu^2].
  template <class T>
  static T factor(const T& a, const T& b, const T& flux_squared) {
    return exponential_saturation(a, b, flux_squared);
  }
};

}  // namespace swingbank::sim
