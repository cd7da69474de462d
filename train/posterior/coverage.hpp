#pragma once
// Calibration checks of posteriors: coverage of central intervals, and rank statistics of the true values per
// parameter (simulation-based calibration, Talts et al. 2018) and of the parameter vector (TARP, Lemos et al.
// 2023).
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "train/posterior/mixture.hpp"
#include "train/posterior/recalibration.hpp"

namespace swingbank::train::posterior {

inline constexpr std::size_t kRankBins = 20;

/// Histogram of ranks in bins of equal probability.
struct Ranks {
  std::array<std::size_t, kRankBins> count{};
  [[nodiscard]] std::size_t rows() const;
  /// Returns chi-square of the counts against equal counts, with kRankBins - 1 degrees of freedom.
  [[nodiscard]] double chi_square() const;
  /// Returns the p-value of chi_square().
  [[nodiscard]] double by_chance() const;
  /// Returns the largest distance of the cumulative histogram from that of uniform ranks, as a share of the
  /// rows.
  [[nodiscard]] double largest_distance() const;
};

struct ParameterCoverage {
  double within_50 = 0.0, within_90 = 0.0;  ///< shares of rows whose central interval contains the true value
  double width_50 = 0.0, width_90 = 0.0;    ///< mean interval widths, as shares of the box
  Ranks ranks;
};

struct Coverage {
  std::vector<ParameterCoverage> parameters;
  Ranks tarp;  ///< ranks of the true value's distance from a random point of the box
  /// Returns the mean of a quantity over the parameters.
  [[nodiscard]] double mean(double ParameterCoverage::*of) const;
};

/// Computes the coverage. places: positions of the true values in their boxes, rows x parameters;
/// recalibrations: one per parameter.
Coverage coverage(const Posteriors& posteriors, std::span<const Recalibration> recalibrations,
                  std::span<const double> places, std::uint64_t seed);

/// Returns the normal scores of the true values under the posteriors, rows x parameters.
std::vector<double> scores(const Posteriors& posteriors, std::span<const double> places);
/// Return the position in the box with normal score `score` or with cumulative probability `p`.
double quantile_of_score(const Mixture& posterior, const Recalibration& recalibration, double score);
double quantile(const Mixture& posterior, const Recalibration& recalibration, double p);

}  // namespace swingbank::train::posterior
