#pragma once
// Training loop: Adam with early stopping on the validation rows; the weights of the best epoch are kept. A
// resumed run is bitwise equal to an uninterrupted one. Every random number is a function of seed, epoch and
// batch, so that no generator state is saved. Several ranks can train one network together: each processes a
// part of every batch, and the gradients are summed. Weights and moments are then the same on all ranks, and
// equal those of a run with one rank except for rounding.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <vector>

#include "mpi/items/ranks.hpp"
#include "train/data/features.hpp"
#include "train/data/shard_stream.hpp"
#include "train/loop/experiment.hpp"
#include "train/loop/learning_curve.hpp"
#include "train/loop/progress.hpp"
#include "train/networks/network.hpp"

namespace at {
class Tensor;
}

namespace swingbank::train::loop {

/// Training rows of one epoch.
struct EpochRows {
  std::shared_ptr<const data::ShardStream> stream;
  std::vector<std::uint64_t> rows;  ///< row numbers, ascending
  std::vector<float> targets;       ///< scaled targets, all rows of the stream x outputs
};

struct LoopData {
  const data::ShardStream& stream;
  const data::Features& features;
  std::span<const std::uint64_t> train, validation;  ///< row numbers, ascending
  std::span<const float> targets;                    ///< scaled targets, all rows of the dataset x outputs
  /// Estimates to correct, all rows x outputs [scaled]; they are appended to the features.
  std::span<const float> guesses = {};
  std::span<const float> weights = {};  ///< weights of the outputs' squared errors, mean 1; empty: equal
  /// Scalar loss of outputs and scaled targets; empty: Network::loss, else weighted mean squared error.
  std::function<at::Tensor(const at::Tensor&, const at::Tensor&)> loss = {};
  /// Returns the training rows of an epoch, from 1; none if a signal asks to stop. An epoch reads at most as
  /// many rows as `train` has. Empty: every epoch reads the rows `train`. Not together with guesses.
  std::function<std::optional<EpochRows>(std::size_t epoch)> fresh = {};
};

struct LoopSettings {
  TrainingRecipe recipe;
  std::uint64_t seed = 1;
  std::filesystem::path checkpoint;       ///< empty: no checkpoints
  const nlohmann::json* run = nullptr;    ///< identity of the run; a checkpoint of another run is an error
  double checkpoint_every_s = 30.0;       ///< interval of checkpoints within an epoch [s]
  double checkpoint_after_epoch_s = 2.0;  ///< an epoch's end saves one if the last is older than this [s]
  std::uint64_t first_draw = 0;           ///< noise realisation of the first epoch; each epoch uses the next
  double gflops = 0.0;                    ///< peak rate of matrix products [GFLOP/s]; 0: unknown
  std::function<bool()> stop;             ///< polled before each batch; empty: stop_asked()
  const mpi::items::Ranks* ranks = nullptr;  ///< ranks that train together; null: this process alone
  /// Called on rank 0 with the curve so far, after each epoch and after a resume; may be empty.
  std::function<void(const LearningCurve&)> epoch_done;
};

struct LoopReport {
  bool finished = false;  ///< false: stopped on request, after a checkpoint
  std::size_t epochs = 0, best_epoch = 0;
  double seconds = 0.0;  ///< wall clock, including time before a resume [s]
  /// Validation loss of the best epoch: weighted squared error in scaled units, or LoopData::loss if given.
  double validation = 0.0;
  double processor_seconds = 0.0;  ///< of all threads and ranks, including before a resume [core-s]
  LearningCurve curve;             ///< all epochs, including before a resume
};

/// Trains the network, which then has the weights of its best epoch. Collective over the ranks: they must
/// have the same data and settings, and a batch must have a row for each rank. Only rank 0 reads and writes
/// the checkpoint. Throws InputError on all ranks if the loss is not finite or the checkpoint cannot be used.
LoopReport train_network(networks::Network& network, const LoopData& data, const LoopSettings& settings,
                         TrainingProgress& progress);

/// Returns the network's outputs for `rows`, rows x outputs [scaled units]. `guesses`: as in LoopData;
/// `noise`: default is that of test rows; `computed` is called with the number of rows so far.
std::vector<float> predict(networks::Network& network, const data::ShardStream& stream,
                           const data::Features& features, std::span<const std::uint64_t> rows,
                           std::span<const float> guesses = {}, const std::optional<data::Noise>& noise = {},
                           const std::function<void(std::size_t)>& computed = {});

/// Returns Adam's learning rate at a step (from 0) of `steps` steps.
double learning_rate(const TrainingRecipe& recipe, std::uint64_t step, std::uint64_t steps);
/// Seeds torch's random generator, which creates the initial weights.
void seed_torch(std::uint64_t key);

}  // namespace swingbank::train::loop
