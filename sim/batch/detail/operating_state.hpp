#pragma once
// Data of one operating point of the grid: its network and the initial state of every source.
#include <memory>
#include <vector>

#include "sim/batch/detail/internal_network.hpp"
#include "sim/plant/plant.hpp"

namespace swingbank::sim::batch {

/// Network and initial states of a grid at its operating point.
struct OperatingState {
  /// The grid must outlive this object.
  explicit OperatingState(const grid::Grid& at);
  explicit OperatingState(std::shared_ptr<const grid::Grid> at) : OperatingState(*at) {
    kept = std::move(at);
  }
  /// Returns the initial state of a plant of the grid with other parameters. Throws what operating_point()
  /// throws.
  [[nodiscard]] plant::Operating bring(const plant::Plant& plant) const;

  std::shared_ptr<const grid::Grid> kept;
  const grid::Grid& grid;
  InternalNetwork network;
  std::vector<plant::Operating> plants, loads;  ///< initial states with the grid's own parameters
};

}  // namespace swingbank::sim::batch
