#pragma once
// What lanes need of one operating point of the grid: its network, and every source brought to it.
#include <memory>
#include <vector>

#include "sim/lanes/detail/internal_network.hpp"
#include "sim/plant/plant.hpp"

namespace swingbank::sim::lanes {

struct OperatingState {
  /// A grid that outlives this.
  explicit OperatingState(const grid::Grid& at);
  explicit OperatingState(std::shared_ptr<const grid::Grid> at) : OperatingState(*at) {
    kept = std::move(at);
  }
  /// A plant of the grid, with other parameters, brought to the operating point. Throws as operating_point.
  [[nodiscard]] plant::Operating bring(const plant::Plant& plant) const;

  std::shared_ptr<const grid::Grid> kept;
  const grid::Grid& grid;
  InternalNetwork network;
  std::vector<plant::Operating> plants, loads;  ///< with the grid's own parameters
};

}  // namespace swingbank::sim::lanes
