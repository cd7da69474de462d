#pragma once
// What a run's network believes: the head behind it, set right level by level on rows that did not train, and
// judged on the rows that the run is judged on.
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "base/json.hpp"
#include "train/loop/loop.hpp"
#include "train/posterior/coverage.hpp"
#include "train/posterior/head.hpp"
#include "train/run/run.hpp"

namespace swingbank::train::run {

/// Maps of the parameters that vary, at one level of noise.
struct LevelMaps {
  double level = 0.0;
  std::vector<posterior::Recalibration> maps;
};

/// Those of a level, between its neighbours.
std::vector<posterior::Recalibration> maps_at(const std::vector<LevelMaps>& levels, double level);

struct Posterior {
  std::unique_ptr<posterior::Head> head;  ///< none: nothing is believed
  std::vector<LevelMaps> levels;          ///< ascending
};

/// What a posterior is made of and judged with.
struct PosteriorContext {
  const data::ShardStream& stream;
  const data::Features& features;
  const data::TargetScale& scale;
  const data::RowSplit& split;
  const loop::TrainingRecipe& recipe;
  std::uint64_t seed = 1;
};

/// An untrained one. Throws InputError if the network describes nothing.
std::unique_ptr<posterior::Head> make_head(networks::Network& network, const mpi::store::Dataset& dataset,
                                           const data::TargetScale& scale, std::size_t inputs);
/// Trains the head and sets it right. False if it was stopped, after a checkpoint.
bool train_posterior(Posterior& posterior, networks::Network& network, const PosteriorContext& context,
                     loop::LoopSettings settings, std::span<const float> targets,
                     loop::TrainingProgress& progress);
/// For the result file: coverage, ranks and widths on the test rows, and on the rows of the same generator
/// that never train.
nlohmann::json judge_posterior(const Posterior& posterior, const PosteriorContext& context);

/// The estimate of a plant from several test rows by the product of their beliefs, raw units; held parameters
/// at the middle of their box.
std::function<std::vector<double>(std::span<const std::size_t>)> product_of_beliefs(
    const Posterior& posterior, const PosteriorContext& context);

/// For the network file, and back. Throws what nlohmann::json throws.
nlohmann::json maps_json(const Posterior& posterior);
std::vector<LevelMaps> maps_of(const nlohmann::json& json);

}  // namespace swingbank::train::run
