#pragma once
// Uncertainty of a playback of P and Q due to their noise and to their unknown values between the samples
// around a switching. During a fault the voltage responds to these errors many times more strongly than
// elsewhere, and the rotor angle retains the error.
#include "validate/compare/compare.hpp"

namespace swingbank::validate::compare {

/// Sets EventComparison::doubt of an event whose P and Q were played in. It repeats the playback with each
/// uncertain quantity changed by one standard deviation.
void add_power_doubt(const plant::PlantModel& model, const playin::PlayInOptions& options,
                     EventComparison& e);

}  // namespace swingbank::validate::compare
