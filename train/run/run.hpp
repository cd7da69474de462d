#pragma once
// One run: split, features, training, score, JSON. Used by `swingbank train` and, fold by fold, by
// `swingbank cross-validate`.
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "train/data/shard_stream.hpp"
#include "train/data/split.hpp"
#include "train/loop/experiment.hpp"
#include "train/loop/loop.hpp"
#include "train/loop/metrics.hpp"
#include "train/runtime/runtime.hpp"

namespace swingbank::train::run {

struct RunRequest {
  loop::Experiment experiment;
  std::string preset, network;
  std::optional<std::int32_t> generator;  ///< to leave out; none: 60/20/20
  std::optional<std::int32_t> judged;     ///< generator that the run is judged on instead, also left out
  std::uint64_t seed = 1;
  std::optional<std::size_t> epochs;  ///< instead of the preset's
  double noise = 0;  ///< level of measurement noise; the stream must have been opened with it
  std::optional<std::size_t> test_rows;  ///< about so many, evenly spread; none: all
  double train_share = 1.0;              ///< of the training rows
  bool shuffle_labels = false;
  bool any_maker = false;    ///< what other software or kernels made counts as this run's
  bool save_network = true;  ///< beside the result (not of a control run)
  std::filesystem::path out;
  runtime::Runtime runtime;
  bool quiet = false;
  std::function<bool()> stop = {};  ///< asked before each batch; empty: stop_asked()
};

enum class RunOutcome { done, already_done, stopped };

/// Trains, scores and writes the JSON of train/run/README.md. Goes on from a checkpoint of the same run.
/// Throws InputError if the output folder holds the result of another run under the same name, or of other
/// software, or a checkpoint of other software or kernels, or if another process is at this very run
/// (RunLock).
RunOutcome run(const data::ShardStream& stream, const RunRequest& request);

/// Targets of all rows in scaled units. With `shuffled`, the labels of the training and validation rows
/// change places; those of other rows stay.
std::vector<float> scaled_targets(const data::Labels& labels, const data::TargetScale& scale,
                                  const data::RowSplit& split, bool shuffled, std::uint64_t seed);
/// "V-cnn-quick-seed1-gen30"
std::string run_name(const RunRequest& request);
/// The same without the noise that it is judged with, where the network serves all levels.
std::string training_name(const RunRequest& request);

}  // namespace swingbank::train::run
