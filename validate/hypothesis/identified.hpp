#pragma once
// Search among hypotheses that act through torque or field voltage. Each is identified first: simulated
// without the rest of the plant and fitted to the inferred input (validate/reduced). Then it is fitted with
// the whole plant.
#include <functional>
#include <vector>

#include "validate/hypothesis/search.hpp"

namespace swingbank::validate::hypothesis {

/// Returns whether a hypothesis on this base model can be identified without the rest of the plant. Its
/// effect must act only through torque or field voltage, and the plant must be a whole synchronous machine.
/// No record may contain a breaker operation, an open circuit or a staged test.
bool can_be_identified(const BaseModel& base_model, const Hypothesis& h);

/// Sets the gain of hypotheses that were identified but not fitted: the best gain of a fitted hypothesis
/// minus `behind`.
void place_unfitted(std::vector<Judgement>& all);

/// Returns every hypothesis in descending order of evidence, without those that have no influence on the
/// response. Hypotheses that may come within reach of the best one are fitted. `fit_others` fits the
/// hypotheses that cannot be identified without the rest of the plant. It is called once, with the lowest
/// cost of a whole-plant fit so far, and returns the lowest cost including its own fits. Hypotheses whose
/// cost is far above the returned cost are not fitted here.
std::vector<Judgement> identified(const BaseModel& base_model, std::vector<Hypothesis> all,
                                  const std::function<double(double least)>& fit_others,
                                  const event::Progress& report);

}  // namespace swingbank::validate::hypothesis
