#pragma once
// Addition of one effect by one fit from its default values, for the live page.
#include <optional>

#include "validate/add/add.hpp"

namespace swingbank::validate::add {

/// Fits the effect's own parameters and then all parameters to the seen events. Empty unless the residual of
/// every seen event is noise; add_effects() searches further than this. Sets hypothesis, effects, model,
/// parameters, own, with, adequate and sentence of the addition. Omits the refit without the effect (so there
/// is no evidence) and the widening of the intervals for coloured noise.
std::optional<Addition> add_at_once(const plant::PlantModel& model, const hypothesis::Hypothesis& hypothesis,
                                    const std::vector<record::Record>& records, const AddOptions& options);

}  // namespace swingbank::validate::add
