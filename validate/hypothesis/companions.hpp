#pragma once
// Search for a missing effect of the machine or of an instrument in addition to a missing control. Such
// effects are columns of the reduced plant, and each control is identified with each of them free. If such an
// effect is missing but not tried, the control that is selected is often the wrong one.
#include <vector>

#include "validate/hypothesis/polish.hpp"

namespace swingbank::validate::hypothesis {

/// Finds the companion of each control on the leader's side: the effect that most reduces the control's cost.
/// With the companion, this cost must be below that of the best control alone by more than
/// thresholds::evidence.second. `leader` must have a fit. Throws InputError if the leader's plant cannot be
/// simulated.
void find_companions(const BaseModel& base_model, const Polish& polish, const Identified& leader,
                     std::vector<Identified>& tried);

}  // namespace swingbank::validate::hypothesis
