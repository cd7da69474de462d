#pragma once
// An experiment: one table of results, of the thesis or not, as configs/experiments/*.toml states it.
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

/// How the weights are found.
struct TrainingRecipe {
  std::size_t epochs = 0, batch = 0;
  double learning_rate = 0.0;  ///< of Adam
  std::string
      schedule;  ///< "constant", or "cosine": falls to a hundredth over the epochs, after a short warm-up
  std::size_t patience = 0;       ///< epochs without a better validation error before stopping
  double validation_share = 0.0;  ///< of the training generators' databank points (leave-one-generator-out)
  /// A parameter's squared error, in units of its variance, counts as its variance to this power: 0 counts
  /// all parameters alike, 1 as the tables do (raw units).
  double loss_power = 0.0;
  double weight_decay = 0.0;   ///< of matrices, per step and learning rate (Loshchilov and Hutter 2019)
  double clip = 0.0;           ///< longest gradient; 0: any
  double average = 0.0;        ///< share that the averaged weights keep a step; 0: the last weights count
  bool training_rows = false;  ///< the rows of the training dataset train too
  std::string kind = {};       ///< file of train/networks; usually the name it has in the experiment
  std::string corrects = {};   ///< method of train/direct whose estimates it reads and corrects; empty: none
  /// Every row draws a level in every epoch; the network is told it and serves all levels. None: rows train
  /// with the noise that they are judged with.
  std::optional<data::NoiseLevels> noise_levels = {};
  std::size_t posterior_epochs = 0;  ///< of the head that says what is to be believed; 0: there is none
  std::size_t set_aside = 0;         ///< generators whose rows calibrate beliefs and do not train
};

/// What a network reads.
struct NetworkInput {
  data::InputRecipe recipe;
  std::size_t pca_components = 0;  ///< per second and channel, per channel of the form "physics"; 0: none
};

/// On what a network is judged, and trained as far as noise goes.
struct Judging {
  std::vector<double> noise;        ///< levels of measurement noise (sim/core/measurement_noise.hpp); 0: none
  std::size_t test_rows = 0;        ///< about so many, evenly spread; 0: all
  std::vector<double> shares = {};  ///< of the training rows: a run more each, of the first level and fold
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

/// A run of the preset: one result file.
struct Task {
  std::string network;
  double noise = 0.0;
  std::string fold;    ///< bus number of the generator left out; "none": the experiment splits its rows
  double share = 1.0;  ///< of the training rows that train
};

/// What Experiment::print knows. "training_rows": the networks that train on them; "tasks": network, noise
/// level and fold of each run, and its share of the training rows where that is not all.
inline constexpr std::array<const char*, 8> kPrintable = {
    "table", "dataset", "draws", "training_dataset", "training_draws", "training_rows", "networks", "tasks"};

struct Experiment {
  std::filesystem::path file;
  std::string table;  ///< "IV", "V" or "VI" of the thesis; else the file's own name, which results then bear
  std::string title;
  std::filesystem::path dataset;           ///< its config
  std::filesystem::path training_dataset;  ///< config of rows that only train; empty: none
  bool leave_one_out = false;              ///< otherwise 60/20/20 by databank point, or
  bool across = false;              ///< the dataset is judged whole and the training dataset alone trains
  std::vector<std::int32_t> folds;  ///< generators (bus numbers) to leave out, empty for a split
  std::map<std::string, Preset> presets;

  /// Throws InputError that lists what there is.
  [[nodiscard]] const Preset& preset(const std::string& name) const;
  [[nodiscard]] const TrainingRecipe& training(const std::string& preset, const std::string& network) const;
  [[nodiscard]] const NetworkInput& input(const std::string& preset, const std::string& network) const;
  [[nodiscard]] const Judging& judging(const std::string& preset, const std::string& network) const;
  /// In the order in which they are to be run.
  [[nodiscard]] std::vector<Task> tasks(const std::string& preset) const;
  /// One word or list for scripts, one a line; "none" where there is nothing. Throws InputError for another
  /// key than kPrintable's.
  [[nodiscard]] std::string print(const std::string& preset, const std::string& key) const;
};

/// Throws InputError with every problem of the file.
Experiment read_experiment(const std::filesystem::path& file);

}  // namespace swingbank::train::loop
