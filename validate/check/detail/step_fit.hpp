#pragma once
// Consistency of a record's columns at voltage steps. When the network switches, the current step of a
// synchronous machine follows from the voltage step: dV = -jX'' dI (Kundur, Power System Stability and
// Control, 3.6). The rest of the plant has no influence. A large deviation indicates wrong columns or bases.
#include <string>
#include <vector>

#include "validate/record/record.hpp"
#include "validate/switching/step_intervals.hpp"

namespace swingbank::validate::check {

/// Least-squares fit of the steps to dV = -jX dI.
struct StepFit {
  double reactance = 0;             ///< X [pu on the record's base]; X'' in a sound record
  double residual = 1;              ///< residual share of sum |dV|^2: below 0.03 plus noise in sound records
  double voltage = 0, current = 0;  ///< mean |dV|^2 and |dI|^2 of a step [pu^2]
};
/// Fits the steps with P and Q taken `delay` samples later than the voltage. Returns NaN if voltage or
/// current does not change.
StepFit fit_steps(const record::Record& record, const std::vector<switching::StepInterval>& steps, int delay);

/// Returns the delay of P and Q relative to the voltage [samples] if it is the same at every step, otherwise
/// 0.
int power_delay(const record::Record& record, const std::vector<switching::StepInterval>& steps);

}  // namespace swingbank::validate::check
