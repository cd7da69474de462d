#pragma once
// Experiment: one table of results, as defined in configs/experiments/*.toml.
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "train/data/downsample.hpp"
#include "train/data/noise.hpp"

namespace swingbank::train::loop {

/// Training settings of a network.
struct TrainingRecipe {
  std::size_t epochs = 0, batch = 0;
  double learning_rate = 0.0;     ///< learning rate of Adam
  std::string schedule;           ///< "constant", or "cosine": short warm-up, then decay to 1 %
  std::size_t patience = 0;       ///< epochs without improvement before stopping
  double validation_share = 0.0;  ///< fraction of the training generators' databank samples for validation
  /// Exponent of the loss weights: variance^power is the weight of a parameter's squared error, relative to
  /// its variance. 0: equal weights; 1: squared error in raw units, as in the tables.
  double loss_power = 0.0;
  double weight_decay = 0.0;   ///< decoupled decay of matrices (Loshchilov and Hutter 2019)
  double clip = 0.0;           ///< largest gradient norm; 0: no clipping
  double average = 0.0;        ///< decay factor of the averaged weights per step; 0: no averaging
  bool training_rows = false;  ///< whether to train on the training dataset's rows too
  std::string kind = {};       ///< file name in train/networks; usually the network's name
  std::string corrects = {};   ///< method of train/direct whose estimates the network corrects; empty: none
  /// Trained network whose estimates the likelihood search starts from; empty: none. The entry itself is then
  /// not trained.
  std::string steps_from = {};
  /// Distribution of the noise levels of training rows. If present, every row has a random level in every
  /// epoch, and the level is an input; one network then serves all levels. If absent, training rows have the
  /// noise of the test rows.
  std::optional<data::NoiseLevels> noise_levels = {};
  std::size_t posterior_epochs = 0;  ///< epochs of the posterior head; 0: no posterior
  std::size_t set_aside = 0;         ///< number of generators used for recalibration, not training
};

/// Input of a network.
struct NetworkInput {
  data::InputRecipe recipe;
  std::size_t pca_components = 0;  ///< per second and channel; form "physics": per channel; 0: no PCA
};

/// Evaluation of a network.
struct Judging {
  std::vector<double> noise;  ///< levels (sim/core/measurement_noise.hpp); 0: no noise
  std::size_t test_rows = 0;  ///< number of rows, drawn at random; 0: all
  std::vector<double> shares =
      {};  ///< fractions of the training rows; one more run each, at the first level and fold
};

struct Preset {
  std::string name;
  std::uint64_t draws = 0;           ///< events to simulate
  std::uint64_t training_draws = 0;  ///< events of the training dataset; 0: none
  std::vector<std::string> networks;
  std::map<std::string, NetworkInput> input;       ///< by network
  std::map<std::string, TrainingRecipe> training;  ///< by network
  std::map<std::string, Judging> judging;          ///< by network
};

/// One run of a preset: one result file.
struct Task {
  std::string network;
  double noise = 0.0;
  std::string fold;    ///< bus number of the left-out generator; "none": no leave-one-out split
  double share = 1.0;  ///< fraction of the training rows that is used
};

/// Keys of Experiment::print. "training_rows": networks that also train on the training dataset. "tasks":
/// network, noise level and fold of each run, followed by its share of the training rows if below 1.
inline constexpr std::array<const char*, 8> kPrintable = {
    "table", "dataset", "draws", "training_dataset", "training_draws", "training_rows", "networks", "tasks"};

/// Split of the rows, in the order of kSplits (train/data/split.hpp).
enum class Split { by_point, by_row, leave_one_out, across };
inline constexpr std::array<const char*, 4> kSplits = {"by-databank-point", "by-row",
                                                       "leave-one-generator-out", "across-datasets"};

struct Experiment {
  std::filesystem::path file;
  std::string table;  ///< "IV", "V" or "VI" of the thesis, else the file's name; part of result names
  std::string title;
  std::filesystem::path dataset;           ///< config of the dataset
  std::filesystem::path training_dataset;  ///< config of additional training rows; empty: none
  Split split = Split::by_point;
  std::vector<std::int32_t> folds;  ///< generators (bus numbers) to leave out, one per fold
  std::map<std::string, Preset> presets;

  /// Return a preset, or its settings for a network. Throw InputError that lists the available names.
  [[nodiscard]] const Preset& preset(const std::string& name) const;
  [[nodiscard]] const TrainingRecipe& training(const std::string& preset, const std::string& network) const;
  [[nodiscard]] const NetworkInput& input(const std::string& preset, const std::string& network) const;
  [[nodiscard]] const Judging& judging(const std::string& preset, const std::string& network) const;
  /// Returns the runs in execution order.
  [[nodiscard]] std::vector<Task> tasks(const std::string& preset) const;
  /// Returns the value of a key for scripts, one word or task per line; "none" if there is none. Throws
  /// InputError for a key outside kPrintable.
  [[nodiscard]] std::string print(const std::string& preset, const std::string& key) const;
};

/// Reads an experiment. Throws InputError with every problem of the file.
Experiment read_experiment(const std::filesystem::path& file);
/// Returns the JSON Schema of experiments.
std::string experiment_schema();

}  // namespace swingbank::train::loop
