#pragma once
// Databank: parameter sets drawn uniformly from a box of parameter intervals, with a minimum distance, by
// Poisson-disk dart throwing. The distance is Euclidean, in raw parameter units or box widths
// (`databank.scale`). Candidate k is a pure function of (seed, k). Candidates are accepted in order, so the
// first n samples depend neither on the number of requested samples nor on the computer. A "databank sample"
// is one parameter set.
#include <map>
#include <string>
#include <vector>

#include "mpi/draw/dataset_config.hpp"

namespace swingbank::mpi::draw {

/// Accepted databank samples and counts of the rejected candidates.
struct Databank {
  std::size_t dimensions = 0;    ///< parameters per sample, including fixed ones
  std::vector<double> values;    ///< samples x dimensions
  std::uint64_t candidates = 0;  ///< number of candidates generated
  std::uint64_t too_close = 0;   ///< number of candidates closer to a sample than the minimum distance
  std::map<std::string, std::uint64_t>
      refused;  ///< number of inadmissible candidates by reason, "not Xd > X'd"

  [[nodiscard]] std::size_t points() const { return dimensions == 0 ? 0 : values.size() / dimensions; }
  [[nodiscard]] const double* point(std::size_t i) const { return values.data() + i * dimensions; }
};

/// Draws `points` databank samples. `base`: the plant with the values of all parameters that are not sampled.
/// Returns fewer samples after a stop signal (stop_signal.hpp). Throws InputError with the number of samples
/// reached if the physical-admissibility policy or the distance cannot be satisfied.
Databank draw_databank(const DatasetConfig& config, const sim::plant::Plant& base, std::uint64_t points);

}  // namespace swingbank::mpi::draw
