#pragma once
// Inertia and damping from the integrated swing equation, which is linear in both.
#include "sim/core/recording.hpp"

namespace swingbank::sim::direct {

/// Estimated inertia constant H and damping D.
struct Swing {
  double H = 0, D = 0;  ///< [s], [pu]
  double residual = 0;  ///< RMS residual, relative to the RMS of the integrated torque
};
/// Powers that the power convention divides by speed: Pm - D w only, or the electrical power as well.
enum class Divided { driving, all };

/// Estimates H and D by least squares from
/// \f[ 2H (\omega - \omega_0) + D \int \frac{\omega}{1+\omega} = \int (\frac{P_m}{1+\omega} - T_e) \f]
/// with the speed deviation omega; the factor 1 + omega is absent in the torque convention. The fit uses the
/// segment after the last voltage step and has a free constant. `Ra`: armature resistance [pu]; its loss is
/// added to P to obtain the air-gap power. Returns zeros if the segment has fewer than kShortestStretch
/// samples.
Swing swing_of(const Recording& record, double Ra, Divided divided);

}  // namespace swingbank::sim::direct
