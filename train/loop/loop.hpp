#pragma once
// Epochs of Adam with early stop on the validation rows; the weights of the best epoch are kept. Bit-exact
// when resumed: every random number is keyed by seed, epoch and batch, so that no generator state needs
// saving.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <vector>

#include "train/data/features.hpp"
#include "train/data/shard_stream.hpp"
#include "train/loop/experiment.hpp"
#include "train/loop/progress.hpp"
#include "train/networks/network.hpp"

namespace at {
class Tensor;
}

namespace swingbank::train::loop {

struct LoopData {
  const data::ShardStream& stream;
  const data::Features& features;
  std::span<const std::uint64_t> train, validation;  ///< row numbers, ascending
  std::span<const float> targets;                    ///< all rows of the dataset x outputs, scaled
  std::span<const float> guesses = {};  ///< all rows x outputs, scaled: read behind each row's features
  std::span<const float> weights = {};  ///< of the outputs' squared errors, mean 1; empty: all alike
  /// Of outputs and scaled targets, instead of the mean squared error; a number.
  std::function<at::Tensor(const at::Tensor&, const at::Tensor&)> loss = {};
};

struct LoopSettings {
  TrainingRecipe recipe;
  std::uint64_t seed = 1;
  std::filesystem::path checkpoint;       ///< empty: none is written
  const nlohmann::json* run = nullptr;    ///< identity of the run; a checkpoint of another one is refused
  double checkpoint_every_s = 30.0;       ///< in an epoch
  double checkpoint_after_epoch_s = 2.0;  ///< at the end of an epoch, where the last one is that old
  std::uint64_t first_draw = 0;           ///< of the noise of training rows; each epoch has the next one
  double gflops = 0.0;                    ///< what the processor makes of products [GFLOP/s]; 0: not known
  std::function<bool()> stop;             ///< asked before each batch; empty: stop_asked()
};

struct LoopReport {
  bool finished = false;  ///< false: stopped on request, after a checkpoint
  std::size_t epochs = 0, best_epoch = 0;
  double seconds = 0.0;  ///< wall clock, those before a resume included [s]
  double validation =
      0.0;  ///< loss of the best epoch on the validation rows: squared error in scaled units, weighted
  double processor_seconds = 0.0;  ///< of all threads, those before a resume included [core-s]
};

/// Trains; the network ends with the weights of its best epoch. Throws InputError if the loss stops being a
/// number.
LoopReport train_network(networks::Network& network, const LoopData& data, const LoopSettings& settings,
                         TrainingProgress& progress);

/// Network's outputs for `rows`, rows x outputs, scaled units. `guesses`: as in LoopData; `noise`: that of
/// judging unless given.
std::vector<float> predict(networks::Network& network, const data::ShardStream& stream,
                           const data::Features& features, std::span<const std::uint64_t> rows,
                           std::span<const float> guesses = {}, const std::optional<data::Noise>& noise = {});

/// Rate of Adam at a step (from 0) of all steps.
double learning_rate(const TrainingRecipe& recipe, std::uint64_t step, std::uint64_t steps);
/// Seeds the generator that weights and dropout draw from.
void seed_torch(std::uint64_t key);

}  // namespace swingbank::train::loop
