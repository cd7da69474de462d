#pragma once
// Hypotheses that act through torque or field voltage, identified against the time series that the records
// ask for (validate/reduced), then fitted with the whole plant from there.
#include <functional>
#include <vector>

#include "validate/hypothesis/search.hpp"

namespace swingbank::validate::hypothesis {

/// Whether a hypothesis of this stage can be identified so: its effect acts through one of these inputs
/// alone, and the recorded voltage drives a synchronous machine.
bool can_be_identified(const Stage& stage, const Hypothesis& h);

/// Gives those that were identified and not fitted the evidence of the best one, less what they are behind.
void place_unfitted(std::vector<Judgement>& all);

/// Every hypothesis, the best first; those that could still become probable beside the best one are fitted.
/// What answers nothing is left out. `fit_others` fits the hypotheses of other kinds: it is called once, with
/// the least cost of a whole plant so far, and returns that of theirs, so that nothing is fitted here that is
/// far behind them.
std::vector<Judgement> identified(const Stage& stage, std::vector<Hypothesis> all,
                                  const std::function<double(double least)>& fit_others,
                                  const event::Progress& report);

}  // namespace swingbank::validate::hypothesis
