#pragma once
// Change of a grid's operating point: the same buses, plants and models with other loads, dispatch, voltages
// and machine bases.
#include <cstddef>

#include "sim/grid/grid.hpp"

namespace swingbank::sim::grid {

/// Returns the grid with `network`, which is its own network with other loads, generation, regulated voltages
/// or branches in service. Solves the power flow and updates plants and dynamic loads. Throws what
/// solve_power_flow() throws, and InputError if a dynamic load has no consumption.
Grid at_operating_point(const Grid& grid, network::Network network);

/// Sets a plant's machine base [MVA]. Its parameters keep their per-unit values on the new base; its power in
/// MW is unchanged.
void set_machine_base(Grid& grid, std::size_t plant, double mva);

}  // namespace swingbank::sim::grid
