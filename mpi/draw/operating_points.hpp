#pragma once
// Operating points drawn at random: loads, dispatch, held voltages, lines out of service and machine bases of
// a block of draws. A pure function of (config, block): what cannot be used is drawn again with the next key.
#include <cstdint>
#include <memory>
#include <optional>

#include "mpi/draw/dataset_config.hpp"

namespace swingbank::mpi::draw {

/// How often a block's operating point was drawn again, by reason.
struct Redrawn {
  std::uint32_t no_power_flow = 0;  ///< Newton's method found none
  std::uint32_t implausible = 0;    ///< a voltage or a generator outside of what OperatingPoints allows
};

struct OperatingPoint {
  std::shared_ptr<const sim::grid::Grid> grid;
  Redrawn redrawn;
};

class OperatingPoints {
 public:
  explicit OperatingPoints(const Study& study) : study_(study) {}
  /// The operating point of a block; the latest one is kept. Throws InputError if too many draws in a row
  /// cannot be used.
  const OperatingPoint& at(std::uint64_t block);

 private:
  const Study& study_;
  std::uint64_t block_ = 0;
  std::optional<OperatingPoint> latest_;
};

}  // namespace swingbank::mpi::draw
