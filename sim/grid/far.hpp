#pragma once
// What plants' controls measure elsewhere in the grid: found in the network, and measured in its power flow.
#include "sim/grid/grid.hpp"

namespace swingbank::sim::grid {

/// Finds the bus and the branch that the controls of every plant name (Plant::far_place), and measures there.
/// Where the network has no such bus or branch in service, a remark says that the control measures at its
/// plant.
void look_far(Grid& grid);
/// Measures anew, after another power flow (Plant::far).
void measure_far(Grid& grid);

}  // namespace swingbank::sim::grid
