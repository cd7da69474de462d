#pragma once
// The JSON of one run; its keys stand in train/run/README.md.

#include "base/json.hpp"
#include "train/run/run.hpp"

namespace swingbank::train::run {

/// The config's name; the folder's, if the dataset was made before headers had a name.
std::string dataset_name(const mpi::store::Dataset& dataset);

/// What tells this run from every other: data, recipe, seed; software and kernels too, unless any maker will
/// do. A checkpoint or result with another identity is not its.
nlohmann::json identity(const data::ShardStream& stream, const RunRequest& request);

/// What tells the training of this run from every other: a network that was trained at many levels of noise
/// serves the runs of all of them.
nlohmann::json training_identity(const data::ShardStream& stream, const RunRequest& request);

struct RunParts {
  const data::RowSplit& split;
  const data::Features* features;  ///< nullptr: nothing was trained
  const loop::LoopReport& report;
  const loop::Score& score;
  std::optional<double> seen_mse = {};  ///< of the validation rows, raw units
  nlohmann::json posterior = {};        ///< null where there is none
  nlohmann::json several = {};          ///< the same
};
nlohmann::json result_json(const data::ShardStream& stream, const RunRequest& request, const RunParts& parts);

}  // namespace swingbank::train::run
