#pragma once
// A start of the search straight from the records: the machine's closed form, where it has one and the
// records show what it needs.
#include <optional>

#include "validate/event/event.hpp"
#include "validate/fit/fit.hpp"

namespace swingbank::validate::calibrate {

/// Values of the free parameters by the closed form of the plant's machine: of each event, smoothed, then the
/// median over the events. None where the machine has no closed form, where anything stands around it (its
/// torque and its field have to be constant, and its terminal the record's), where an event lacks speed or
/// field current, or where the values contradict the machine's equations.
std::optional<std::vector<double>> closed_start(const sim::plant::PlantUnderTest& tested,
                                                const event::WhitenedEvents& events,
                                                const std::vector<fit::FreeParameter>& free);

}  // namespace swingbank::validate::calibrate
