#pragma once
// The runs of one table, preset and dataset, and what their figures are over seeds and generators.
#include <optional>
#include <string>
#include <vector>

#include "validate/report/run_result.hpp"

namespace swingbank::validate::report {

/// Without control runs, those that recipes are chosen by, and those on a share of the rows.
struct Task {
  std::string table, preset, dataset, dataset_hash;
  std::int64_t rows = 0;
  std::vector<RunResult> runs;
  /// In the tables' order: the thesis's networks, other networks, what is not trained, the floor.
  [[nodiscard]] std::vector<std::string> methods() const;
  [[nodiscard]] std::vector<double> levels() const;   ///< of noise, rising
  [[nodiscard]] std::vector<int> generators() const;  ///< left out; of Table V and VI at least the thesis's
  [[nodiscard]] std::vector<std::string> makers() const;
};
/// In the order of the thesis's tables, then of presets and rows.
std::vector<Task> tasks_of(const std::vector<RunResult>& results);

constexpr int kAnyGenerator = -1;
/// Which runs of a task a figure is of.
struct Of {
  std::string method;
  double noise = 0;
  int generator = kAnyGenerator;
};
std::vector<const RunResult*> runs_of(const Task& task, const Of& of);

/// Mean over generators of the means over seeds.
struct Figure {
  double mse = 0, ratio = 0, baseline = 0;
  double spread = 0;  ///< standard deviation of the seeds' means
  std::size_t seeds = 0, generators = 0;
  std::optional<double> over_floor;  ///< quotient over the runs for which there is a floor
};
std::optional<Figure> figure_of(const Task& task, const Of& of);

struct ParameterFigure {
  std::string name, unit;
  double mse = 0;
  std::optional<double> relative;  ///< mean squared error over mean variance; none for a constant
};
std::vector<ParameterFigure> parameter_figures(const Task& task, const Of& of);

/// Of predicting the mean, on all test rows; mean over the generators where any will do. NaN without runs.
double baseline_of(const Task& task, int generator = kAnyGenerator);

/// The thesis's figure, of a network that it has not its best; mean over the generators of the task.
std::optional<double> thesis_mean(const Task& task, const std::string& method);

/// "CNN", "MLP corrects", "closed form".
std::string method_name(const std::string& network);
/// "no noise", "noise 0.1 %".
std::string level_name(double noise);
/// Three digits.
std::string shown(double v);

}  // namespace swingbank::validate::report
