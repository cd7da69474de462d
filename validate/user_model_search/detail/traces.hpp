#pragma once
// Data of the search: the inferred input and the signals along the events.
#include "validate/reduced/free_input.hpp"
#include "validate/user_model_search/candidate.hpp"

namespace swingbank::validate::user_model_search {

/// Returns one trace per event. The signals are those of the playback model with the inferred input. `level`:
/// see trigger_level().
std::vector<UserModelTrace> user_model_traces(const plant::PlantModel& model,
                                              const noise::WhitenedEvents& events,
                                              const reduced::FreeInput& input, double level);

}  // namespace swingbank::validate::user_model_search
