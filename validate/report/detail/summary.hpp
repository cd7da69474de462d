#pragma once
// Runs of one table, preset and dataset, and their means over seeds and generators.
#include <optional>
#include <string>
#include <vector>

#include "validate/report/run_result.hpp"

namespace swingbank::validate::report {

/// Runs of one task. Excluded are control runs, runs with --judge-on, and runs on a share of the training
/// rows.
struct Task {
  std::string table, preset, dataset, dataset_hash;
  std::int64_t rows = 0;
  std::vector<RunResult> runs;
  /// Methods in the tables' order: the thesis's networks, other networks, untrained methods, the floor.
  [[nodiscard]] std::vector<std::string> methods() const;
  [[nodiscard]] std::vector<double> levels() const;   ///< noise levels in rising order
  [[nodiscard]] std::vector<int> generators() const;  ///< excluded; includes the thesis's for Tables V and VI
  [[nodiscard]] std::vector<std::string> makers() const;
};
/// Groups the results into tasks, sorted by the thesis's tables, then preset and rows.
std::vector<Task> tasks_of(const std::vector<RunResult>& results);

constexpr int kAnyGenerator = -1;
/// Selection of a task's runs.
struct Of {
  std::string method;
  double noise = 0;
  int generator = kAnyGenerator;
};
std::vector<const RunResult*> runs_of(const Task& task, const Of& of);

/// Mean over seeds of the means over generators.
struct Figure {
  double mse = 0, ratio = 0, baseline = 0;
  double standard_deviation = 0;  ///< standard deviation of the seeds' means
  std::size_t seeds = 0, generators = 0;
  std::optional<double> over_floor;  ///< ratio to the floor over the runs that have one
};
std::optional<Figure> figure_of(const Task& task, const Of& of);

struct ParameterFigure {
  std::string name, unit;
  double mse = 0;
  std::optional<double> relative;  ///< mean squared error / mean variance; none for a constant
};
std::vector<ParameterFigure> parameter_figures(const Task& task, const Of& of);

/// MSE of predicting the mean on all test rows; mean over the generators for kAnyGenerator. NaN without runs.
double baseline_of(const Task& task, int generator = kAnyGenerator);

/// The thesis's MSE for the method, otherwise for the thesis's best network; mean over the task's generators.
std::optional<double> thesis_mean(const Task& task, const std::string& method);

/// Name in tables: "CNN", "MLP corrects", "closed form".
std::string method_name(const std::string& network);
/// "no noise", "noise 0.1 %".
std::string level_name(double noise);
/// Number with three digits; "–" if not finite.
std::string shown(double v);

}  // namespace swingbank::validate::report
