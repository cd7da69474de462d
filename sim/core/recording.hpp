#pragma once
// Record of a machine's terminal quantities: uniform samples, per unit on the machine's base.
#include <vector>

#include "sim/core/effect.hpp"
#include "sim/core/measurement_noise.hpp"

namespace swingbank::sim {

/// The first samples are in steady state; the event begins later. The angle is continuous (unwrapped).
struct Recording {
  double step = 0.0;                          ///< sampling interval [s]
  Conventions conventions;                    ///< conventions of the machine's equations
  std::vector<double> V, theta, P, Q, speed;  ///< samples [pu], theta [rad]; P, Q out of the machine
  MeasurementNoise noise = {};                ///< measurement noise of the samples, if known
  double event = 0.0;                         ///< start of the event [s]; 0: unknown
  std::vector<double> Ifd;  ///< field current [pu, 1 on the air-gap line]; empty: not recorded
};

}  // namespace swingbank::sim
