#pragma once
// Runge-Kutta pairs of the playback integrators, and their step control.
#include <algorithm>
#include <cmath>

#include "sim/plant/tableau.hpp"

namespace swingbank::validate::playin {

/// Embedded Runge-Kutta pair whose last stage is the first of the next step (FSAL).
struct Pair {
  int stages;
  double exponent;  ///< exponent of the error in step control
  const double (*a)[6];
  const double *c, *error;
};
inline constexpr Pair kFineSteps{sim::plant::dp54::kStages, -1.0 / 5, sim::plant::dp54::a,
                                 sim::plant::dp54::c, sim::plant::dp54::error};
/// Bogacki and Shampine 3(2), Appl. Math. Lett. 2 (1989) 321. It needs half the work of the 5(4) pair if
/// steps must end at every sample and the voltage is noisy.
inline constexpr double kRoughA[4][6] = {{}, {1.0 / 2}, {0.0, 3.0 / 4}, {2.0 / 9, 1.0 / 3, 4.0 / 9}};
inline constexpr double kRoughC[4] = {0.0, 1.0 / 2, 3.0 / 4, 1.0};
inline constexpr double kRoughError[4] = {2.0 / 9 - 7.0 / 24, 1.0 / 3 - 1.0 / 4, 4.0 / 9 - 1.0 / 3, -1.0 / 8};
inline constexpr Pair kRoughSteps{4, -1.0 / 3, kRoughA, kRoughC, kRoughError};
inline constexpr double kRoughTolerance = 1e-5;  ///< tolerance from which kRoughSteps is used
inline constexpr double kShortestStep = 1e-9;    ///< a run that needs a shorter step fails [s]

/// Returns the power of an error for next_step(), approximately.
inline double rough_power(double error, const Pair& pair) {
  return sim::plant::dp54::rough_power(static_cast<float>(error + 1e-12), static_cast<float>(pair.exponent));
}
/// Returns the length of the next step after an attempt of length h [s]. `error`: error of the attempt
/// relative to the tolerance; `power`: this error raised to Pair::exponent. A step that ended early at a
/// target time (`reaches`) does not shorten `longest`, the length planned before the attempt.
inline double next_step(double longest, double h, double error, double power, bool reaches) {
  const double factor = std::isfinite(error) ? std::clamp(0.9 * power, 0.2, 5.0) : 0.2;
  return reaches && error <= 1 ? std::max(longest, h * factor) : h * factor;
}

}  // namespace swingbank::validate::playin
