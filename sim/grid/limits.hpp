#pragma once
// Operating points beyond a control's limits: all reported at once, or the limits widened, as in PSS/E.
#include "sim/grid/grid.hpp"

namespace swingbank::sim::grid {

/// Checks that every plant can hold its operating point. Throws one InputError that lists all infeasible
/// plants. `widen`: if only limits prevent the operating point, the limits of the plant's controls are moved
/// as far as it requires and no further, each with a remark and a warning.
void settle_limits(Grid& grid, bool widen);

}  // namespace swingbank::sim::grid
