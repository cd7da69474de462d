#pragma once
// The databank: parameters of machine and other effects drawn uniformly from their boxes such that any two
// points keep a distance. Candidate k is a pure function of (seed, k); candidates are settled in order, so
// the first n points are the same whatever n, and on every machine.
#include <map>
#include <string>
#include <vector>

#include "mpi/draw/dataset_config.hpp"

namespace swingbank::mpi::draw {

struct Databank {
  std::size_t dimensions = 0;  ///< entries of the box, held ones included
  std::vector<double> values;  ///< points x dimensions
  std::uint64_t draws = 0;     ///< candidates drawn
  std::uint64_t too_close = 0;
  std::map<std::string, std::uint64_t> refused;  ///< by reason: "not Xd > X'd", "singular: ..."

  [[nodiscard]] std::size_t points() const { return dimensions == 0 ? 0 : values.size() / dimensions; }
  [[nodiscard]] const double* point(std::size_t i) const { return values.data() + i * dimensions; }
};

/// Draws `points` points. `base`: the plant that tells what is not in the box. Throws InputError telling how
/// many points were reached if the policy or the distance cannot be met. Fewer points come back where a
/// signal asked for an end (stop_signal.hpp).
Databank draw_databank(const DatasetConfig& config, const sim::plant::Plant& base, std::uint64_t points);

}  // namespace swingbank::mpi::draw
