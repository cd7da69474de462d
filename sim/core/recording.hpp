#pragma once
// What a recorder at a machine's terminal shows: uniform samples, per unit on the machine's base.
#include <vector>

#include "sim/core/effect.hpp"
#include "sim/core/measurement_noise.hpp"

namespace swingbank::sim {

/// The first samples are steady: the event begins later. The angle is continuous (unwrapped).
struct Recording {
  double step = 0.0;                          ///< [s]
  Conventions conventions;                    ///< of whatever made the record
  std::vector<double> V, theta, P, Q, speed;  ///< [pu], theta [rad]; P and Q out of the machine
  MeasurementNoise noise = {};                ///< of its samples, as far as it is known
  double event = 0.0;                         ///< when the event begins [s]; 0: the record does not say
  std::vector<double> Ifd;                    ///< [pu, 1 on the air-gap line]; empty: not recorded
};

}  // namespace swingbank::sim
