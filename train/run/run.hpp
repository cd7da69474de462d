#pragma once
// One run: split, features, training, score, JSON. Used by `swingbank train` and, for each fold, by
// `swingbank cross-validate`.
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "mpi/items/ranks.hpp"
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
  std::optional<std::int32_t> generator;  ///< left-out generator; none: another split
  std::optional<std::int32_t> judged;     ///< generator tested instead of `generator`; also left out
  std::uint64_t seed = 1;
  std::optional<std::size_t> epochs;     ///< overrides the preset's value
  double noise = 0;                      ///< noise level; must equal that of the stream
  std::optional<std::size_t> test_rows;  ///< number of rows, drawn at random; none: all
  double train_share = 1.0;              ///< fraction of the training rows that is used
  bool shuffle_labels = false;
  bool any_maker = false;    ///< accept results of other software or kernels
  bool save_network = true;  ///< write the network beside the result, except for a control run
  std::filesystem::path out;
  runtime::Runtime runtime;
  bool quiet = false;
  bool watch = false;  ///< draw the learning curve on the terminal
  std::chrono::milliseconds patience{
      5000};                        ///< waiting time for a process of this run; 12 h with noise levels
  std::function<bool()> stop = {};  ///< polled before each batch; empty: stop_asked()
  const mpi::items::Ranks* ranks = nullptr;  ///< ranks that train together; null: this process alone
  /// Returns the stream of new events for an epoch, from 1; null if a signal asks to stop. Empty: every epoch
  /// reads the same training rows.
  std::function<std::shared_ptr<const data::ShardStream>(std::size_t epoch,
                                                         const data::StreamOptions& options)>
      fresh = {};
};

enum class RunOutcome { done, already_done, stopped };

/// Trains, scores and writes the JSON of train/run/README.md. Continues from a checkpoint of the same run.
/// Throws InputError if the existing result or checkpoint belongs to another run or other software, or if
/// another process still works on this run after the waiting time (RunLock). A checkpoint must also have the
/// same kernels.
/// Collective over the ranks, which have the same request and dataset; only rank 0 scores and writes files.
RunOutcome run(const data::ShardStream& stream, const RunRequest& request);

/// Returns the targets of all rows in scaled units. With `shuffled`, the labels of training and validation
/// rows are permuted; the other labels are unchanged.
std::vector<float> scaled_targets(const data::Labels& labels, const data::TargetScale& scale,
                                  const data::RowSplit& split, bool shuffled, std::uint64_t seed);
/// Returns the name of the result, such as "V-cnn-quick-seed1-gen30".
std::string run_name(const RunRequest& request);
/// Returns the name of the training: the name of the result, without the noise level if the network serves
/// all levels.
std::string training_name(const RunRequest& request);

}  // namespace swingbank::train::run
