#pragma once
// What plants' controls measure elsewhere in the grid: found in the network, and measured in its power flow.
#include <string>
#include <vector>

#include "sim/grid/grid.hpp"

namespace swingbank::sim::grid {

/// A bus or a branch that a control names and the network does not have in service.
struct NotThere {
  std::string control;  ///< its effect
  std::string what;     ///< "bus 999"
};
/// Finds the bus and the branch that the controls of a plant name (Plant::far_place), and measures there. For
/// what is not there the control measures at its plant.
std::vector<NotThere> look_far(const Grid& grid, plant::Plant& plant);
/// The same of every plant; a remark tells what is not there.
void look_far(Grid& grid);
/// Measures anew, after another power flow (Plant::far).
void measure_far(Grid& grid);

}  // namespace swingbank::sim::grid
