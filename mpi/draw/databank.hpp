#pragma once
// Databank: parameter sets drawn uniformly from their boxes with a minimum distance between any two points
// (Poisson-disk sampling by dart throwing). Candidate k is a pure function of (seed, k). Candidates are
// accepted in order, so the first n points are the same for any number of points and on every machine.
#include <map>
#include <string>
#include <vector>

#include "mpi/draw/dataset_config.hpp"

namespace swingbank::mpi::draw {

/// Accepted points and counts of the rejected candidates.
struct Databank {
  std::size_t dimensions = 0;                    ///< number of parameters, including fixed ones
  std::vector<double> values;                    ///< points x dimensions
  std::uint64_t draws = 0;                       ///< number of candidates drawn
  std::uint64_t too_close = 0;                   ///< candidates rejected by the distance
  std::map<std::string, std::uint64_t> refused;  ///< inadmissible candidates by reason: "not Xd > X'd"

  [[nodiscard]] std::size_t points() const { return dimensions == 0 ? 0 : values.size() / dimensions; }
  [[nodiscard]] const double* point(std::size_t i) const { return values.data() + i * dimensions; }
};

/// Draws `points` points. `base`: the plant with the values of all parameters outside the box. Returns fewer
/// points after a stop signal (stop_signal.hpp). Throws InputError with the number of points reached if the
/// policy or the distance cannot be satisfied.
Databank draw_databank(const DatasetConfig& config, const sim::plant::Plant& base, std::uint64_t points);

}  // namespace swingbank::mpi::draw
