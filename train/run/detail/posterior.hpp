#pragma once
// Posterior of a trained network: training of the head, recalibration at each noise level with rows that were
// not used in training, and calibration checks on the test rows.
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "base/json.hpp"
#include "train/loop/loop.hpp"
#include "train/posterior/coverage.hpp"
#include "train/posterior/head.hpp"
#include "train/run/detail/prepare.hpp"

namespace swingbank::train::run {

/// Recalibration maps of the varying parameters at one noise level.
struct LevelMaps {
  double level = 0.0;
  std::vector<posterior::Recalibration> maps;
};

/// Returns the maps at a noise level, interpolated between the neighbouring levels.
std::vector<posterior::Recalibration> maps_at(const std::vector<LevelMaps>& levels, double level);

struct Posterior {
  std::unique_ptr<posterior::Head> head;  ///< nullptr: no posterior
  std::vector<LevelMaps> levels;          ///< in ascending order of level
};

/// Result of a training.
struct Trained {
  data::Features features;
  std::unique_ptr<networks::Network> network;
  Posterior posterior;
  loop::LoopReport report;
};

/// Creates an untrained head. Throws InputError if the network provides no features.
std::unique_ptr<posterior::Head> make_head(networks::Network& network, const mpi::store::Dataset& dataset,
                                           const data::TargetScale& scale, std::size_t inputs);
/// Trains and recalibrates the head. Returns false if the training was stopped; a checkpoint is then saved.
bool train_posterior(Trained& trained, const PreparedRun& run, loop::LoopSettings settings,
                     std::span<const float> targets, loop::TrainingProgress& progress);
/// Returns coverage, ranks and widths for the result file, on the test rows. With a training dataset and
/// generators set aside, also on that dataset's rows of the left-out generator, which are never used in
/// training.
nlohmann::json judge_posterior(const PreparedRun& run, const Trained& trained);

/// Returns a function that estimates a plant's parameters [raw units] from several test rows by the product
/// of their posteriors. Constant parameters keep their value.
std::function<std::vector<double>(std::span<const std::size_t>)> product_of_posteriors(
    const PreparedRun& run, const Trained& trained);

/// Convert the maps to JSON for the network file, and back. Throw nlohmann::json's exceptions.
nlohmann::json maps_json(const Posterior& posterior);
std::vector<LevelMaps> maps_of(const nlohmann::json& json);

}  // namespace swingbank::train::run
