#pragma once
// Scaling laws of a network's error against training rows and processor time.
#include <optional>
#include <string>
#include <vector>

#include "validate/report/detail/power_law.hpp"
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
  /// Error against training rows and against processor time; none with fewer sizes than kLeastSizes.
  [[nodiscard]] std::optional<PowerLaw> by_rows() const;
  [[nodiscard]] std::optional<PowerLaw> by_time() const;
};
/// Minimum number of sizes: for a power law, and for a plot.
inline constexpr std::size_t kLeastSizes = 4, kSizesToDraw = 3;

/// Series with at least kSizesToDraw sizes, from all trained runs except control runs and runs with
/// --judge-on.
std::vector<ScalingSeries> scaling_series(const std::vector<RunResult>& results);
/// Table of exponents, of the error at the thesis's number of rows, and of the rows for the thesis's error.
Table scaling_table(const std::vector<ScalingSeries>& series);
std::string scaling_picture(const std::vector<ScalingSeries>& series);

}  // namespace swingbank::validate::report
