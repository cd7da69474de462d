#pragma once
// Closed-form estimates of the machine's parameters from the records, as starts of the search.
#include <vector>

#include "validate/event/event.hpp"
#include "validate/fit/fit.hpp"

namespace swingbank::validate::calibrate {

/// Returns up to two starts: medians over the events of the closed-form values of the free parameters, from
/// the original records and from smoothed records (against noise). Values that contradict the machine's
/// equations are left out. The closed form requires constant torque and field voltage and records of the
/// machine's terminal. Returns none if the machine has no closed form, or if the plant has a transformer,
/// controls or instruments. Also returns none if a record is of a staged test, lacks speed, or lacks the
/// field current of a machine with a field winding.
std::vector<std::vector<double>> closed_starts(const sim::plant::PlantUnderTest& tested,
                                               const noise::WhitenedEvents& events,
                                               const std::vector<fit::FreeParameter>& free);

}  // namespace swingbank::validate::calibrate
