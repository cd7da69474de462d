#pragma once
// Preparation of a run: identity, split of the rows and scale of the targets.
#include "base/json.hpp"
#include "train/run/run.hpp"

namespace swingbank::train::run {

/// Values of a run that are known before training or estimation.
struct PreparedRun {
  const data::ShardStream& stream;
  const RunRequest& request;
  const loop::TrainingRecipe& recipe;
  nlohmann::json identity;  ///< two runs with equal identities give the same result
  /// Identity of the training. A network trained at many noise levels serves the runs of all levels.
  nlohmann::json training_identity;
  data::RowSplit split;
  data::TargetScale scale;  ///< scale of the targets
};

/// Whether the request trains a network: it is neither a method of train/direct nor a search from a network's
/// estimates.
bool is_trained(const RunRequest& request);

/// Splits the rows and fits the scale of the targets. Throws InputError if a method needs complete records
/// but the dataset is not on disk.
PreparedRun prepare(const data::ShardStream& stream, const RunRequest& request);

/// Returns the rows of a stream of new events that may be trained on: all but those of the generators left
/// out or set aside; with a split across datasets, those of the training dataset only. Throws InputError if
/// there are none.
std::vector<std::uint64_t> trainable(const data::Labels& labels, const PreparedRun& run);

}  // namespace swingbank::train::run
