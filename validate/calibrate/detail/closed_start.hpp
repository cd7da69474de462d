#pragma once
// A start of the search straight from the records: the machine's closed form, where it has one and the
// records show what it needs.
#include <vector>

#include "validate/event/event.hpp"
#include "validate/fit/fit.hpp"

namespace swingbank::validate::calibrate {

/// Values of the free parameters by the closed form of the plant's machine: of each event, then the median
/// over the events; of the records as they are and, for noisy ones, smoothed. None where the machine has no
/// closed form, where anything stands around it (its torque and its field have to be constant, and its
/// terminal the record's), where an event lacks speed or field current, or where the values contradict the
/// machine's equations.
std::vector<std::vector<double>> closed_starts(const sim::plant::PlantUnderTest& tested,
                                               const event::WhitenedEvents& events,
                                               const std::vector<fit::FreeParameter>& free);

}  // namespace swingbank::validate::calibrate
