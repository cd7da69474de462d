#pragma once
// What laws are searched in: the inferred input and the signals along the events.
#include "validate/laws/candidate.hpp"
#include "validate/reduced/free_input.hpp"

namespace swingbank::validate::laws {

/// One trace per event; signals are those of the plant driven with the inferred input. `level` as from
/// trigger_level.
std::vector<LawTrace> law_traces(const plant::PlantModel& model, const event::WhitenedEvents& events,
                                 const reduced::FreeInput& input, double level);

}  // namespace swingbank::validate::laws
