#pragma once
// Error of a network against training rows and processor time.
#include <string>
#include <vector>

#include "validate/report/document.hpp"
#include "validate/report/run_result.hpp"

namespace swingbank::validate::report {

/// Results at one number of training rows: means over seeds and over the generators common to all sizes.
struct Size {
  double rows = 0, core_seconds = 0, mse = 0, epochs = 0;  ///< of one run, on average
  double low = 0, high = 0;                                ///< least and largest of the seeds' means
};
/// Runs of one network with several numbers of training rows.
struct ScalingSeries {
  std::string table, network;
  double noise = 0;
  std::vector<int> generators;  ///< excluded at all sizes; empty: none was excluded
  std::vector<Size> sizes;      ///< sorted by rows
  [[nodiscard]] std::string name() const;
};
/// Minimum number of sizes.
inline constexpr std::size_t kSizesToDraw = 3;

/// Series with at least kSizesToDraw sizes, from all trained runs except control runs and runs with
/// --judge-on.
std::vector<ScalingSeries> scaling_series(const std::vector<RunResult>& results);
/// Table with rows, epochs, processor time and error of each size.
Table scaling_table(const std::vector<ScalingSeries>& series);
std::string scaling_picture(const std::vector<ScalingSeries>& series);

}  // namespace swingbank::validate::report
