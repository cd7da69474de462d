#pragma once
// Scores of a network in raw units, and of the baseline, the mean of the training targets as a constant
// prediction.
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace swingbank::train::loop {

struct ParameterScore {
  std::string name, unit;
  double mse = 0.0;                                      ///< [unit^2]
  double baseline_mse = 0.0;                             ///< MSE of predicting the training mean [unit^2]
  double variance = 0.0;                                 ///< variance over the test rows [unit^2]
  double box_variance = 0.0;                             ///< variance over the box, (high - low)^2 / 12
  [[nodiscard]] std::optional<double> relative() const;  ///< mse / variance; none if variance is 0
};

struct Score {
  std::vector<ParameterScore> parameters;
  double mse = 0.0, baseline_mse = 0.0;                          ///< mean over all parameters
  double mse_varied_only = 0.0, baseline_mse_varied_only = 0.0;  ///< over the parameters that vary in the box
  double ratio = 0.0;                                            ///< mse / baseline_mse
  std::optional<double> H_ratio;                                 ///< ratio of H alone; none without H
  /// Over the rows' own MSE (mean over the parameters): median, largest, and share of rows whose MSE is not
  /// below baseline_mse.
  double median_row = 0.0, worst_row = 0.0, failed_rows = 0.0;
};

struct ScoreInput {
  std::span<const double> predicted, truth;  ///< rows x parameters, raw units
  std::span<const double> training_mean;     ///< one value per parameter
  std::vector<std::string> names, units;
  std::vector<double> low, high;  ///< ends of the parameter intervals
};
Score score(const ScoreInput& input);

}  // namespace swingbank::train::loop
