#pragma once
// JSON result of one run; train/run/README.md lists its keys.

#include <span>

#include "base/json.hpp"
#include "train/run/detail/prepare.hpp"

namespace swingbank::train::run {

/// Returns the config's name, or the folder's if the dataset's header has no name (old datasets).
std::string dataset_name(const mpi::store::Dataset& dataset);

/// Returns the identity of a run: data, recipe, seed, and, unless RunRequest::any_maker is set, software and
/// kernels. A checkpoint or result with another identity does not belong to the run.
nlohmann::json identity(const data::ShardStream& stream, const RunRequest& request);

struct RunParts {
  const data::Features* features;  ///< nullptr: no training
  const loop::LoopReport& report;
  const loop::Score& score;
  std::optional<double> seen_mse = {};  ///< MSE of the validation rows [raw units^2]
  nlohmann::json posterior = {};        ///< null: no posterior
  nlohmann::json several = {};          ///< null: no plant with three test rows
  /// Estimates of the test rows, rows x parameters [raw units]; empty: the method gives none.
  std::span<const double> estimates = {};
};
nlohmann::json result_json(const PreparedRun& run, const RunParts& parts);

}  // namespace swingbank::train::run
