#pragma once
// What laws are searched in.
#include "validate/law_candidate.hpp"
#include "validate/missing_input.hpp"

namespace swingbank::validate {

/// One trace per event; signals are those of the plant driven with the inferred input. `level` as from
/// trigger_level.
std::vector<LawTrace> law_traces(const PlantModel& model, const std::vector<FitEvent>& events,
                                 const MissingInput& input, double level);

}  // namespace swingbank::validate
