#pragma once
// Treatment of operating points beyond a control's limits: reports all of them at once, or widens the limits
// as PSS/E does.
#include "sim/grid/grid.hpp"

namespace swingbank::sim::grid {

/// Checks that every plant can hold its operating point. Throws one InputError that lists all infeasible
/// plants. `widen`: if only limits of the plant's controls prevent the operating point, they are moved no
/// further than required, each with a remark and a warning.
void settle_limits(Grid& grid, bool widen);

}  // namespace swingbank::sim::grid
