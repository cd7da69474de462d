#pragma once
// Calibration checks of posteriors: coverage of central intervals, rank statistics of the truth per parameter
// (simulation-based calibration, Talts et al. 2018) and of the parameter vector (TARP, Lemos et al. 2023).
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
  /// Returns the probability of a chi-square at least as large by chance.
  [[nodiscard]] double by_chance() const;
  /// Returns the largest distance of the cumulative counts from the diagonal, as a share of the rows.
  [[nodiscard]] double largest_distance() const;
};

struct ParameterCoverage {
  double within_50 = 0.0, within_90 = 0.0;  ///< shares of rows whose central interval contains the truth
  double width_50 = 0.0, width_90 = 0.0;    ///< mean interval widths, as shares of the box
  Ranks ranks;
};

struct Coverage {
  std::vector<ParameterCoverage> parameters;
  Ranks tarp;  ///< of the truth's distance from a random point of the box, among the posterior samples'
  /// Returns the mean over the parameters.
  [[nodiscard]] double mean(double ParameterCoverage::*of) const;
};

/// Computes the coverage. places: rows x parameters, positions of the truths in their boxes; recalibrations:
/// one per parameter.
Coverage coverage(const Posteriors& posteriors, std::span<const Recalibration> recalibrations,
                  std::span<const double> places, std::uint64_t seed);

/// Returns the normal scores of the truths under the posteriors, rows x parameters.
std::vector<double> scores(const Posteriors& posteriors, std::span<const double> places);
/// Return the position in the box with normal score `score` or with cumulative probability `p`.
double quantile_of_score(const Mixture& posterior, const Recalibration& recalibration, double score);
double quantile(const Mixture& posterior, const Recalibration& recalibration, double p);

}  // namespace swingbank::train::posterior
