#pragma once
// Closed-form estimates of the machine's parameters from the records, as starts of the search.
#include <vector>

#include "validate/event/event.hpp"
#include "validate/fit/fit.hpp"

namespace swingbank::validate::calibrate {

/// Returns up to two starts: medians over the events of the closed-form values of the free parameters, from
/// the records as recorded and from smoothed records (for noise). Returns none if the machine has no closed
/// form, or if the plant has a transformer, controls or instruments: torque and field must be constant, and
/// the terminal recorded. Returns none either if an event lacks speed, or field current for a machine with a
/// field. Values that contradict the machine's equations are left out.
std::vector<std::vector<double>> closed_starts(const sim::plant::PlantUnderTest& tested,
                                               const noise::WhitenedEvents& events,
                                               const std::vector<fit::FreeParameter>& free);

}  // namespace swingbank::validate::calibrate
