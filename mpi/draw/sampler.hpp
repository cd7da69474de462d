#pragma once
// Random draw of a simulation from its sample number: the generator that varies, its parameters and the
// fault. A pure function of (config, databank, sample_id).
#include <vector>

#include "mpi/draw/databank.hpp"
#include "mpi/draw/dataset_config.hpp"
#include "mpi/draw/operating_points.hpp"

namespace swingbank::mpi::draw {

/// One draw: a simulation job, its recorded generators and their databank points.
struct Draw {
  sim::batch::Job job;
  std::vector<std::size_t> recorded;  ///< recorded generators, as indices into Study::plants
  std::vector<std::size_t> points;    ///< databank point of each recorded generator
  Redrawn redrawn;                    ///< rejected operating points of its block
};

/// Source of the draws of a study.
class Sampler {
 public:
  Sampler(const Study& study, const Databank& bank) : study_(study), bank_(bank), operating_(study) {}
  /// Returns the draw of a sample. With p = sample_id / faults per point and G generators, databank point p
  /// varies generator p mod G, or, if all generators vary, points p G ... p G + G - 1 vary generators 0 ... G
  /// - 1. Draws in ascending order reuse the operating point of their block.
  [[nodiscard]] Draw draw(std::uint64_t sample_id);
  /// Returns why the machines cannot be initialised at their operating point with these parameters; empty if
  /// they can.
  [[nodiscard]] std::string refusal(const Draw& draw) const;

 private:
  const Study& study_;
  const Databank& bank_;
  OperatingPoints operating_;
};

}  // namespace swingbank::mpi::draw
