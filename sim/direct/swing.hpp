#pragma once
// Inertia and damping from the swing equation in integrated form, which is linear in both.
#include "sim/core/recording.hpp"

namespace swingbank::sim::direct {

struct Swing {
  double H = 0, D = 0;  ///< [s], [pu]
  double residual = 0;  ///< root mean square of what is left, as a share of the integrated torque's
};
/// What a machine divides by speed where the convention is power: Pm - D w, or the electrical power as well.
enum class Divided { driving, all };

/// 2H (w - w0) + D int w/(1 + w) = int (Pm/(1 + w) - Te), w the speed deviation, without 1 + w where the
/// convention is torque. Everything behind the last leap of the voltage counts; a constant is free. Ra: what
/// heats the armature is no torque's [pu]. Zeros where that leaves fewer than kShortestStretch samples.
Swing swing_of(const Recording& record, double Ra, Divided divided);

}  // namespace swingbank::sim::direct
