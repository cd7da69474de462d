#pragma once
// How a network's error falls with its training rows and with time: series of runs of several sizes, and the
// power laws through them.
#include <optional>
#include <string>
#include <vector>

#include "validate/report/detail/power_law.hpp"
#include "validate/report/page.hpp"
#include "validate/report/run_result.hpp"

namespace swingbank::validate::report {

/// Means over seeds and over the generators that every size has.
struct Size {
  double rows = 0, core_seconds = 0, mse = 0, epochs = 0;  ///< of one run
  double low = 0, high = 0;                                ///< of the seeds' means
};
struct ScalingSeries {
  std::string table, network;
  double noise = 0;
  std::vector<int> generators;  ///< that all sizes left out; empty: none was
  std::vector<Size> sizes;      ///< by rows
  [[nodiscard]] std::string name() const;
  /// Against rows, against time; none with fewer sizes than kLeastSizes.
  [[nodiscard]] std::optional<PowerLaw> by_rows() const;
  [[nodiscard]] std::optional<PowerLaw> by_time() const;
};
inline constexpr std::size_t kLeastSizes = 4, kSizesToDraw = 3;

/// Of all trained runs that are no control runs: those with at least kSizesToDraw sizes.
std::vector<ScalingSeries> scaling_series(const std::vector<RunResult>& results);
/// Exponents, and when the thesis's size and figure would be reached.
Table scaling_table(const std::vector<ScalingSeries>& series);
std::string scaling_picture(const std::vector<ScalingSeries>& series);

}  // namespace swingbank::validate::report
