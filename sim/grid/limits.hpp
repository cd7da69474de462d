#pragma once
// Operating points beyond a control's limits: all told at once, or the limits moved there, as PSS/E does.
#include "sim/grid/grid.hpp"

namespace swingbank::sim::grid {

/// Brings every plant to its operating point; what cannot be held is thrown together.
/// `widen`: where limits alone are in the way, those of the plant's controls are moved to what the operating
/// point needs and not further, each with a remark and a warning.
void settle_limits(Grid& grid, bool widen);

}  // namespace swingbank::sim::grid
