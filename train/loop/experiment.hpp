#pragma once
// An experiment: one table of results, of the thesis or not, as configs/experiments/*.toml states it.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "train/data/downsample.hpp"

namespace swingbank::train::loop {

/// How the weights are found.
struct TrainingRecipe {
  std::size_t epochs = 0, batch = 0;
  double learning_rate = 0.0;  ///< of Adam
  std::string
      schedule;  ///< "constant", or "cosine": falls to a hundredth over the epochs, after a short warm-up
  std::size_t patience = 0;       ///< epochs without a better validation error before stopping
  double validation_share = 0.0;  ///< of the training generators' databank points (leave-one-generator-out)
};

struct Preset {
  std::string name;
  std::uint64_t draws = 0;  ///< events to simulate
  std::vector<std::string> networks;
  std::vector<double> noise;  ///< levels of measurement noise (sim/core/measurement_noise.hpp); 0: none
  data::InputRecipe input;
  std::size_t pca_components = 0;                  ///< per second and channel; 0: none
  std::map<std::string, TrainingRecipe> training;  ///< by network
};

struct Experiment {
  std::filesystem::path file;
  std::string table;  ///< "IV", "V" or "VI" of the thesis; else the file's own name, which results then bear
  std::string title;
  std::filesystem::path dataset;    ///< its config
  bool leave_one_out = false;       ///< otherwise 60/20/20 by databank point
  std::vector<std::int32_t> folds;  ///< generators (bus numbers) to leave out, empty for a split
  std::map<std::string, Preset> presets;

  /// Throws InputError that lists what there is.
  [[nodiscard]] const Preset& preset(const std::string& name) const;
  [[nodiscard]] const TrainingRecipe& training(const std::string& preset, const std::string& network) const;
  /// One word or list for scripts: table, dataset, draws, networks, noise, folds ("none" for a split), one a
  /// line. Throws InputError for another key.
  [[nodiscard]] std::string print(const std::string& preset, const std::string& key) const;
};

/// Throws InputError with every problem of the file.
Experiment read_experiment(const std::filesystem::path& file);

}  // namespace swingbank::train::loop
