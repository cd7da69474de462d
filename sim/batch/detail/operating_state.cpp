#include "sim/batch/detail/operating_state.hpp"

#include "sim/plant/load_equations.hpp"

namespace swingbank::sim::batch {

OperatingState::OperatingState(const grid::Grid& at) : grid(at), network(at) {
  for (const plant::Plant& plant : grid.plants) plants.push_back(bring(plant));
  for (const plant::Consumer& load : grid.loads)
    loads.push_back(plant::load_operating_point(load, load.block.p,
                                                grid.flow.voltage[static_cast<std::size_t>(load.bus)],
                                                grid.network.base_mva, grid.conventions));
}

plant::Operating OperatingState::bring(const plant::Plant& plant) const {
  return plant::operating_point(plant, grid.flow.voltage[static_cast<std::size_t>(plant.bus)],
                                grid.network.base_mva, grid.conventions);
}

}  // namespace swingbank::sim::batch
