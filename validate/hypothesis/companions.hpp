#pragma once
// Search for a missing effect of the machine or of an instrument in addition to a missing control. Such
// effects are additional columns of the linearised plant's Jacobian, and each control is identified with them
// free. If such an effect is missing too but not tried, the search often selects the wrong control.
#include <vector>

#include "validate/hypothesis/polish.hpp"

namespace swingbank::validate::hypothesis {

/// Finds the companion of each control on the leader's side: the effect that most reduces the control's cost.
/// With the companion, this cost must be below that of the best control alone by more than
/// thresholds::evidence.second. `leader`: the control with the best fit. Throws InputError if the leader's
/// plant cannot be simulated.
void find_companions(const BaseModel& base_model, const Polish& polish, const Identified& leader,
                     std::vector<Identified>& tried);

}  // namespace swingbank::validate::hypothesis
