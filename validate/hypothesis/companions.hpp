#pragma once
// Search for a missing effect of the machine or of an instrument in addition to a control. Such effects are
// columns of the reduced plant, and each control is identified with each of them free. A control that is
// selected without the other effect is often the wrong one.
#include <vector>

#include "validate/hypothesis/polish.hpp"

namespace swingbank::validate::hypothesis {

/// Finds the companion of each control on the leader's side. With the companion, the control's cost must be
/// below that of the best control alone by more than thresholds::evidence.second. `leader` must have a fit.
/// Throws InputError if the leader's plant cannot be simulated.
void find_companions(const BaseModel& base_model, const Polish& polish, const Identified& leader,
                     std::vector<Identified>& tried);

}  // namespace swingbank::validate::hypothesis
