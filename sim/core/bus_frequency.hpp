#pragma once
// Frequency deviation of a bus, computed from its voltage phasor.
#include <cmath>

#include "base/constants.hpp"
#include "sim/core/scalar.hpp"

namespace swingbank::sim {

/// Factor 1/(2 pi f0 Tf) from angle lead [rad] to frequency deviation [pu]; the last argument of
/// bus_frequency(). `inverse_Tf` [1/s], `f0` [Hz].
template <class T>
inline T frequency_per_angle(const T& inverse_Tf, double f0) {
  return inverse_Tf * T(1.0 / (constants::turn * f0));
}

/// Returns the frequency deviation [pu] from the voltage V and its lagged copy x = V/(1 + s Tf):
/// \f[ \Delta f = \frac{\mathrm{Im}(V \bar x)}{|V|\,|x|} \frac{1}{2 \pi f_0 T_f} \f]
/// For slow changes this equals s/(1 + s Tf) of the angle. A step of the angle contributes at most 1/(2 pi f0
/// Tf). `squared`: |V|^2 [pu^2]; `per_angle`: the factor of frequency_per_angle().
template <class T>
inline T bus_frequency(const T& Vr, const T& Vi, const T& squared, const T& xr, const T& xi,
                       const T& per_angle) {
  using std::sqrt;
  constexpr double tiny = 1e-24;  // [pu^2], keeps a dual's derivative finite at V = 0
  const T lagged = xr * xr + xi * xi + T(tiny);
  return (Vi * xr - Vr * xi) / sqrt(squared * lagged) * per_angle;
}

}  // namespace swingbank::sim
