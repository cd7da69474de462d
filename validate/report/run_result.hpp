#pragma once
// Result of one training run of `swingbank train` or `swingbank cross-validate` (keys: train/run/README.md).
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/problem.hpp"

namespace swingbank::validate::report {

/// Error of one estimated parameter.
struct ParameterResult {
  std::string name, unit;          ///< name of the parameter; its unit
  double mse = 0, variance = 0;    ///< mean squared error and variance over the test rows [unit^2]
  std::optional<double> relative;  ///< mse / variance; none for a constant parameter
  /// True values of some test rows [unit]; empty for a constant parameter, the floor, and in results of
  /// former versions.
  std::vector<double> truth;
  std::vector<double> estimate;  ///< estimates of these rows [unit]
};
/// Errors after one epoch of a training.
struct EpochResult {
  std::int64_t epoch = 0;  ///< number of the epoch, from 1
  double validation = 0;   ///< validation error, weighted as the training loss [scaled units]
};
/// Coverage of the posterior intervals with probability `nominal`.
struct Coverage {
  double nominal = 0, observed = 0;  ///< nominal and observed share, 0 to 1
  double rows = 0;                   ///< number of evaluated rows
};
/// Errors of estimates from several test records of the same plant.
struct SeveralRecords {
  std::int64_t at_most = 0,
               plants = 0;  ///< maximum of records used per plant; number of plants with at least three
  double records = 0;       ///< mean number of records used per plant
  double mse_of_mean = 0;   ///< MSE of the mean of the records' estimates, raw units
  std::optional<double> mse_of_product;  ///< MSE of the product of the posteriors; none: no posteriors
};
/// MSE of single test rows: median, largest, and share of rows that are no better than predict-the-mean.
struct RowScatter {
  double median = 0;  ///< median of the rows' MSE
  double worst = 0;   ///< largest MSE of a row
  double failed = 0;  ///< share of rows whose MSE is not below that of predict-the-mean, 0 to 1
};
/// Content of a run's result file.
struct RunResult {
  std::filesystem::path file;          ///< the result file
  std::string table, network, preset;  ///< table of the run; its network or method; its preset
  std::string title;                   ///< title of the experiment; empty if the result has none
  std::int64_t seed = 0;               ///< seed of the run
  double noise = 0;                    ///< level of measurement noise; 0: none
  int generator = 0;                   ///< bus of the excluded generator; 0: none
  int judged = 0;                      ///< bus of another generator used for evaluation (--judge-on); 0: none
  std::string dataset, dataset_hash, config_hash;  ///< folder of the dataset; its hashes
  double share = 1;                                ///< share of the training rows used
  std::int64_t rows = 0, train_rows = 0, test_rows = 0, epochs = 0, best_epoch = 0;
  ///< numbers of rows and epochs
  double seconds = 0, seconds_per_epoch = 0;  ///< duration of the training [s]
  double core_seconds = 0;                    ///< processor time of all threads
  double mse = 0, mse_varied_only = 0, baseline_mse = 0, ratio = 0;
  ///< mean over all parameters; over the varying ones; MSE of predicting the training mean; mse /
  ///< baseline_mse

  /// MSE on the validation rows, whose generators also have training rows; NaN: nothing was trained.
  double seen = 0;
  double H_ratio = 0;                       ///< ratio for H alone; NaN if H is constant
  std::optional<RowScatter> scatter;        ///< none in results of former versions
  std::vector<ParameterResult> parameters;  ///< scores of the parameters
  std::vector<EpochResult> curve;           ///< learning curve; empty: nothing was trained
  std::vector<Coverage> coverage;           ///< empty: the method gives no intervals
  std::vector<SeveralRecords> several;      ///< empty: no plant has three test records
  bool shuffled = false;                    ///< control run with shuffled labels
  int threads = 1;                          ///< number of threads
  std::string software, blas;               ///< version of Swingbank; BLAS library
  bool stale = false;                       ///< of other software than the present one (make_tables())
  /// Software and BLAS of the run. Reports note comparisons between different ones.
  [[nodiscard]] std::string maker() const { return software + ", " + blas; }
};

/// Reads every *.json of the folders in the order of their names. Throws InputError with every error of every
/// file: not JSON, missing or mistyped keys, values that are not finite, two results of one run, or a folder
/// without results.
std::vector<RunResult> read_results(const std::vector<std::filesystem::path>& folders);

}  // namespace swingbank::validate::report
