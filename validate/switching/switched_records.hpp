#pragma once
// Switching times of the records of one instrument: found in the voltage, given by the user, or those of a
// breaker.
#include <vector>

#include "validate/switching/switching.hpp"

namespace swingbank::validate::switching {

/// Distance from a switching within which a meter's frequency is not the derivative of its angle [samples].
constexpr double kPeakReach = 2.1;

/// Options of the detection.
struct SwitchingOptions {
  /// Smallest voltage step of a switching [pu]. Switchings are searched with half of this value, because a
  /// filter spreads a step over two intervals. The shape of the steps is determined with the whole value.
  double threshold = kStepThreshold;
  StepShape shape = StepShape::either;  ///< either: determined from the records (step_shape_of)
  double mva = 0;                       ///< rating of all machines whose power the records contain [MVA]
};

/// Returns the angle for the detection of switchings [rad]. An angle integrated from a frequency lacks the
/// steps at switchings, but the power through the transient reactance shows them. Such an angle is replaced
/// by the angle of the voltage relative to the rotor, theta = -0.3 P [pu on `mva`]. A measured angle is
/// returned unchanged.
std::vector<double> angle_seen_by_rotor(const record::Record& record, double mva);

/// Returns the shape of steps as one instrument records them, from all of its records. The first step of each
/// record decides (VoltageSteps::shape_of_first): the steps are filtered if any first step is. If some first
/// steps are sharp and others inconclusive, the most probable window decides (passed_filter). If all are
/// inconclusive, the steps are filtered if any step is spread over several intervals; otherwise the result is
/// `either`. If the angle was integrated, only V is used.
StepShape step_shape_of(const std::vector<record::Record>& records, double threshold);

/// Returns the records of one instrument with their switching times. The voltage at filtered samples is not
/// yet reconstructed (reconstruct_voltage).
std::vector<SwitchedRecord> switched_records(std::vector<record::Record> records,
                                             const SwitchingOptions& options);

}  // namespace swingbank::validate::switching
