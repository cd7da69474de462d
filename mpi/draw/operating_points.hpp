#pragma once
// Random operating points of the grid: loads, dispatch, voltage setpoints, lines out of service and machine
// bases. A block of draws (simulated events) shares one operating point, which is a pure function of (config,
// block). An unusable operating point is drawn again with the next random-number key.
#include <cstdint>
#include <memory>
#include <optional>

#include "mpi/draw/dataset_config.hpp"

namespace swingbank::mpi::draw {

/// Number of rejected operating points of a block, by reason.
struct Redrawn {
  std::uint32_t no_power_flow = 0;  ///< the power flow did not converge
  std::uint32_t implausible = 0;    ///< implausible voltage or generator, or too few removable lines
};

/// Operating point of a block of draws.
struct OperatingPoint {
  std::shared_ptr<const sim::grid::Grid> grid;
  Redrawn redrawn;
};

/// Generator of operating points.
class OperatingPoints {
 public:
  explicit OperatingPoints(const Study& study) : study_(study) {}
  /// Returns the operating point of a block; caches the latest one. Throws InputError if 100 operating points
  /// in a row are unusable.
  const OperatingPoint& at(std::uint64_t block);

 private:
  const Study& study_;
  std::uint64_t block_ = 0;
  std::optional<OperatingPoint> latest_;
};

}  // namespace swingbank::mpi::draw
