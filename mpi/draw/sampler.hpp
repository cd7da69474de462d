#pragma once
// From a sample's number to the run to make: which generator varies, its parameters, the fault. A pure
// function of (config, databank, sample_id).
#include <vector>

#include "mpi/draw/databank.hpp"
#include "mpi/draw/dataset_config.hpp"
#include "mpi/draw/operating_points.hpp"

namespace swingbank::mpi::draw {

/// One draw: the job, and which varied generators (positions in Study::plants) it records with which databank
/// points.
struct Draw {
  sim::lanes::Job job;
  std::vector<std::size_t> recorded;  ///< positions in Study::plants
  std::vector<std::size_t> points;    ///< databank point of each
  Redrawn redrawn;                    ///< of its operating point
};

class Sampler {
 public:
  Sampler(const Study& study, const Databank& bank) : study_(study), bank_(bank), operating_(study) {}
  /// Point p = sample_id / faults per point goes to generator p mod G, or with `all` points p G ... p G + G-1
  /// go to all G generators. Draws in order share the work for their block's operating point.
  [[nodiscard]] Draw draw(std::uint64_t sample_id);
  /// Why the machines cannot be brought to their operating point with these parameters; empty: they can.
  [[nodiscard]] std::string refusal(const Draw& draw) const;

 private:
  const Study& study_;
  const Databank& bank_;
  OperatingPoints operating_;
};

}  // namespace swingbank::mpi::draw
