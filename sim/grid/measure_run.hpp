#pragma once
// The measurement chain behind every plant of a run.
#include <cstdint>
#include <span>
#include <vector>

#include "sim/core/trajectory.hpp"
#include "sim/grid/grid.hpp"
#include "sim/plant/measure.hpp"

namespace swingbank::sim::grid {

/// Replaces V, theta, P and Q of every plant in the run by what is measured: the plant's own measurements,
/// then `chain`. Needs those four channels. Returns the frequency they report [Hz], [plant][sample]. Plant i
/// of the grid draws from its own random numbers. Throws InputError as phasors_of.
std::vector<std::vector<double>> measure_run(const Grid& grid, std::span<const plant::Block> chain,
                                             std::uint64_t seed, Trajectory& run);

}  // namespace swingbank::sim::grid
