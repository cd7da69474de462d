#pragma once
// Treatment of operating points beyond a control's limits: reports all of them at once, or widens the limits
// as PSS/E does.
#include "sim/grid/grid.hpp"

namespace swingbank::sim::grid {

/// Checks that every plant can hold its operating point. Throws one InputError that lists all infeasible
/// plants. `widen`: widens the limits of the plant's controls if they alone prevent the operating point. Each
/// limit is moved no further than required, with a remark and a warning.
void settle_limits(Grid& grid, bool widen);

}  // namespace swingbank::sim::grid
