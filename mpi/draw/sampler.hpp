#pragma once
// Random draw of one simulated event: the varied generator, its parameters and the fault. The draw is a pure
// function of (config, databank, sample_id).
#include <vector>

#include "mpi/draw/databank.hpp"
#include "mpi/draw/dataset_config.hpp"
#include "mpi/draw/operating_points.hpp"

namespace swingbank::mpi::draw {

/// One draw: a simulation job, its recorded generators and their databank samples.
struct Draw {
  sim::batch::Job job;
  std::vector<std::size_t> recorded;  ///< recorded generators, as indices into Study::plants
  std::vector<std::size_t> points;    ///< databank sample of each recorded generator
  Redrawn redrawn;                    ///< rejected operating points of the draw's block
};

/// Source of the draws of a study.
class Sampler {
 public:
  Sampler(const Study& study, const Databank& bank) : study_(study), bank_(bank), operating_(study) {}
  /// Returns the draw of a `sample_id`. Let p = sample_id / (faults per databank sample), rounded down, and G
  /// the number of generators. With Vary::one, generator p mod G gets databank sample p. With Vary::all,
  /// generators 0 ... G - 1 get databank samples p G ... p G + G - 1. Calls in ascending order reuse the
  /// operating point of a block.
  [[nodiscard]] Draw draw(std::uint64_t sample_id);
  /// Returns why these parameters are inadmissible, or why the machines cannot be initialised at their
  /// operating point with them; empty if neither.
  [[nodiscard]] std::string refusal(const Draw& draw) const;

 private:
  const Study& study_;
  const Databank& bank_;
  OperatingPoints operating_;
};

}  // namespace swingbank::mpi::draw
