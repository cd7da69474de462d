#pragma once
// One training run as `swingbank train` and `swingbank cross-validate` write it (train/run/README.md lists
// the keys).
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/problem.hpp"

namespace swingbank::validate::report {

struct ParameterScore {
  std::string name, unit;
  double mse = 0, variance = 0;
  std::optional<double> relative;  ///< mse / variance; none for a parameter that does not vary
};
/// How often the truth lay in intervals that should hold it with a probability of `nominal`.
struct Coverage {
  double nominal = 0, observed = 0;  ///< shares of 1
  double rows = 0;
};
/// Plants of the test estimated from several records each.
struct SeveralRecords {
  std::int64_t at_most = 0, plants = 0;  ///< records used of a plant at most; plants with three or more
  double records = 0;                    ///< used of a plant on average
  double mse_of_mean = 0;                ///< of the mean of the records' estimates, raw units
  std::optional<double> mse_of_product;  ///< of the product of their beliefs; none: it gives none
};
struct RunResult {
  std::filesystem::path file;
  std::string table, network, preset;
  std::string title;  ///< of the experiment; empty in results that do not say
  std::int64_t seed = 0;
  double noise = 0;   ///< level of measurement noise; 0: none
  int generator = 0;  ///< bus of the generator left out; 0: none
  int judged = 0;     ///< bus of the generator judged on in its place, to choose a recipe by; 0: none
  std::string dataset, dataset_hash, config_hash;
  double share = 1;  ///< of the training rows that trained
  std::int64_t rows = 0, train_rows = 0, test_rows = 0, epochs = 0, best_epoch = 0;
  double seconds = 0, seconds_per_epoch = 0;
  double core_seconds = 0;  ///< processor time of all threads
  double mse = 0, mse_varied_only = 0, baseline_mse = 0, ratio = 0;
  double seen = 0;     ///< MSE on rows of generators, or points, that trained; NaN: nothing was trained
  double H_ratio = 0;  ///< NaN where H does not vary
  std::vector<ParameterScore> parameters;
  std::vector<Coverage> coverage;       ///< empty: it gives no intervals
  std::vector<SeveralRecords> several;  ///< empty: no plant has three test records
  bool shuffled = false;
  int threads = 1;
  std::string software, blas;
  /// What made the figures beside data and recipe; results of different makers are compared only with a word.
  [[nodiscard]] std::string maker() const { return software + ", " + blas; }
};

/// Reads every *.json of the folders, in order of their names. Throws InputError with every fault of every
/// file: not JSON, missing or mistyped keys, values that are not finite, two different results for one run, a
/// folder without any.
std::vector<RunResult> read_results(const std::vector<std::filesystem::path>& folders);

}  // namespace swingbank::validate::report
