#pragma once
// Data of the search: the inferred input and the signals along the events.
#include "validate/laws/candidate.hpp"
#include "validate/reduced/free_input.hpp"

namespace swingbank::validate::laws {

/// Returns one trace per event. The signals are those of the playback model with the inferred input. `level`:
/// see trigger_level().
std::vector<LawTrace> law_traces(const plant::PlantModel& model, const event::WhitenedEvents& events,
                                 const reduced::FreeInput& input, double level);

}  // namespace swingbank::validate::laws
