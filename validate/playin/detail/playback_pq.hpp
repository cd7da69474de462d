#pragma once
// Simulation of one plant with its P and Q as inputs, the inverse of plant_playback. The terminal voltage and
// its angle are the response: the voltage at which the machine's internal voltage delivers P + jQ.
#include <vector>

#include "validate/playin/plant_playback.hpp"

namespace swingbank::validate::playin {

/// Specification of one run with P and Q as inputs.
struct PowerPlaybackRun {
  const sim::plant::Plant* plant = nullptr;
  sim::Conventions conventions = {};
  const record::Record* record = nullptr;
  /// P and Q between the samples: power_curve(). Its switchings separate the segments of the run.
  const VoltageCurve* power = nullptr;
  /// Recorded voltage with the same switchings. It only selects the higher or the lower of the two voltages
  /// at which a plant delivers the same P and Q (near a fault).
  const VoltageCurve* voltage = nullptr;
  OperatingPoint start = {};
  double tolerance = 1e-10;  ///< error per step, relative to 1 + |state|
  int step_limit = 2'000'000;
};

/// Response at each sample of the record. No network determines the angle: a constant error of P accelerates
/// the rotor, so the errors of theta and speed grow with time after the event.
struct PowerResponse {
  std::vector<double> V, theta, speed, Efd, Ifd;  ///< [pu], [rad] (unwrapped), [pu]
  int steps = 0;
};

/// Returns the record's P + jQ [pu on its base] as splines per segment; one-sided values are extrapolated.
VoltageCurve power_curve(const record::Record& record, std::vector<Switching> switchings);

/// Returns the plant's response. Throws InputError if the operating point has no steady state, the
/// integration fails, or no terminal voltage delivers P + jQ at some time.
PowerResponse simulate_power_playback(const PowerPlaybackRun& run);

}  // namespace swingbank::validate::playin
