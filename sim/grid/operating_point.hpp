#pragma once
// A grid brought to another operating point: the same buses, plants and models at other loads, dispatch,
// voltages and machine bases.
#include <cstddef>

#include "sim/grid/grid.hpp"

namespace swingbank::sim::grid {

/// The grid with `network`: its own with other loads, generation, held voltages or branches in service.
/// Solves the power flow; plants and loads with a model of their own follow it. Throws InputError as
/// solve_power_flow.
Grid at_operating_point(const Grid& grid, network::Network network);

/// Gives a plant another machine base [MVA]. Its parameters stay as they stand, per unit on it; its power
/// stays in MW.
void set_machine_base(Grid& grid, std::size_t plant, double mva);

}  // namespace swingbank::sim::grid
