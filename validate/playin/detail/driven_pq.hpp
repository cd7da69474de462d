#pragma once
// One plant driven by the P and Q it delivered: the reverse of driven_plant. The terminal voltage is what the
// machine's inner voltage must have there for P + jQ to flow; it and its angle are the answer.
#include <vector>

#include "validate/playin/driven_plant.hpp"

namespace swingbank::validate::playin {

struct PowerDrive {
  const sim::plant::Plant* plant = nullptr;
  sim::Conventions conventions = {};
  const record::Record* record = nullptr;
  /// P and Q between the samples: power_curve(). Its switchings part the run.
  const VoltageCurve* power = nullptr;
  /// The recorded voltage with the same switchings. Only one thing is asked of it: of the two voltages at
  /// which a plant delivers the same P and Q, was it the higher or the lower one (near a fault)?
  const VoltageCurve* voltage = nullptr;
  OperatingPoint start = {};
  double tolerance = 1e-10;  ///< error per step, relative to 1 + |state|
  int step_limit = 2'000'000;
};

/// At each sample of the record. No network ties the angle: a constant error of P turns the rotor ever
/// faster, so theta and speed tell less, the longer ago the event is.
struct PowerResponse {
  std::vector<double> V, theta, speed, Efd, Ifd;  ///< [pu], [rad] (unwrapped), [pu]
  int steps = 0;
};

/// The record's P + jQ [pu on its base] as a curve: splines per segment, one-sided values extrapolated.
VoltageCurve power_curve(const record::Record& record, std::vector<Switching> switchings);

/// Throws InputError if the operating point cannot be held, the equations cannot be integrated, or at some
/// time no terminal voltage lets the machine deliver P + jQ.
PowerResponse drive_by_power(const PowerDrive& run);

}  // namespace swingbank::validate::playin
