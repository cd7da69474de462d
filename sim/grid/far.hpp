#pragma once
// Remote measurements of plants' controls: their location in the network, and their values in its power flow.
#include <string>
#include <vector>

#include "sim/grid/grid.hpp"

namespace swingbank::sim::grid {

/// A bus or branch that a control refers to but that is not in service in the network.
struct NotThere {
  std::string control;  ///< name of its effect
  std::string what;     ///< "bus 999"
};
/// Locates the bus and the branch that the controls of a plant measure (Plant::far_place), and evaluates the
/// measurements. If a bus or branch is missing, the control measures at its plant instead. Returns the
/// missing buses and branches.
std::vector<NotThere> look_far(const Grid& grid, plant::Plant& plant);
/// As above, for every plant; each missing bus or branch becomes a remark.
void look_far(Grid& grid);
/// Re-evaluates the remote measurements (Plant::far) after another power flow.
void measure_far(Grid& grid);

}  // namespace swingbank::sim::grid
