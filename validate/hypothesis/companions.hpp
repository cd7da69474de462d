#pragma once
// What may be missing of the machine or of an instrument beside a control. Such effects are columns of the
// reduced plant, so that each control is identified with each of them free: a control that was chosen while
// the other effect is missing is often the wrong one.
#include <vector>

#include "validate/hypothesis/polish.hpp"

namespace swingbank::validate::hypothesis {

/// Finds the companion of each control of the leader's side with which it leaves less than the best single
/// hypothesis, by what a second effect needs. `leader` has a fit. Throws InputError where that plant cannot
/// be simulated.
void find_companions(const Stage& stage, const Polish& polish, const Identified& leader,
                     std::vector<Identified>& tried);

}  // namespace swingbank::validate::hypothesis
