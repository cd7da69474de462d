#pragma once
// Frequency of a bus from its voltage phasor.
#include <cmath>

#include "base/constants.hpp"
#include "sim/core/scalar.hpp"

namespace swingbank::sim {

/// 1/(2 pi f0 Tf): what bus_frequency() multiplies the angle's lead by. `inverse_Tf` [1/s].
template <class T>
inline T frequency_slope(const T& inverse_Tf, double f0) {
  return inverse_Tf * T(1.0 / (constants::turn * f0));
}

/// Frequency deviation [pu] from a voltage and the same behind a lag, x = V/(1 + s Tf):
///   df = Im(V conj x)/(|V| |x|)/(2 pi f0 Tf)
/// which for slow changes is s/(1 + s Tf) of the angle; `squared`: |V|^2, and a jump of the angle counts at
/// most 1/(2 pi f0 Tf).
template <class T>
inline T bus_frequency(const T& Vr, const T& Vi, const T& squared, const T& xr, const T& xi, const T& slope) {
  using std::sqrt;
  constexpr double tiny = 1e-24;  // [pu^2] a dual needs a slope at V = 0
  const T lagged = xr * xr + xi * xi + T(tiny);
  return (Vi * xr - Vr * xi) / sqrt(squared * lagged) * slope;
}

}  // namespace swingbank::sim
