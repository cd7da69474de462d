#pragma once
// Measurement chains of the plants of a run.
#include <cstdint>
#include <span>
#include <vector>

#include "sim/core/trajectory.hpp"
#include "sim/grid/grid.hpp"
#include "sim/plant/measure.hpp"

namespace swingbank::sim::grid {

/// Replaces V, theta, P and Q of every plant in the run by the outputs of the simulated instruments. The
/// plant's own measurement effects act first, then `chain`. The run must have these four channels. Returns
/// the measured frequency [Hz] as [plant][sample]. Each plant has its own random-number stream. Throws what
/// phasors_of() throws.
std::vector<std::vector<double>> measure_run(const Grid& grid, std::span<const plant::Block> chain,
                                             std::uint64_t seed, Trajectory& run);

}  // namespace swingbank::sim::grid
