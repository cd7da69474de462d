#pragma once
// How honest beliefs are: how often intervals hold the truth, ranks of the truth parameter by parameter
// (simulation-based calibration, Talts et al. 2018) and of the vector (TARP: Lemos et al. 2023).
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "train/posterior/mixture.hpp"
#include "train/posterior/recalibration.hpp"

namespace swingbank::train::posterior {

inline constexpr std::size_t kRankBins = 20;

/// Ranks in bins of equal probability.
struct Ranks {
  std::array<std::size_t, kRankBins> count{};
  [[nodiscard]] std::size_t rows() const;
  /// Of the counts about equal ones; kRankBins - 1 degrees of freedom.
  [[nodiscard]] double chi_square() const;
  /// Probability of a chi-square as large or larger by chance.
  [[nodiscard]] double by_chance() const;
  /// Largest distance of the summed counts from the diagonal, as a share of the rows.
  [[nodiscard]] double largest_distance() const;
};

struct ParameterCoverage {
  double within_50 = 0.0, within_90 = 0.0;  ///< shares of the rows whose central interval holds the truth
  double width_50 = 0.0, width_90 = 0.0;    ///< mean widths, as shares of the box
  Ranks ranks;
};

struct Coverage {
  std::vector<ParameterCoverage> parameters;
  Ranks tarp;  ///< of the truth's distance from a random point of the box, among the beliefs' samples
  /// Mean over the parameters.
  [[nodiscard]] double mean(double ParameterCoverage::*of) const;
};

/// places: rows x parameters, of the truths in their boxes; recalibrations: one a parameter.
Coverage coverage(const Beliefs& beliefs, std::span<const Recalibration> recalibrations,
                  std::span<const double> places, std::uint64_t seed);

/// Normal scores of the truths under the beliefs, rows x parameters.
std::vector<double> scores(const Beliefs& beliefs, std::span<const double> places);
/// The place in the box that stands for the normal score `score`, and the one below which the belief puts the
/// probability p.
double quantile_of_score(const Mixture& belief, const Recalibration& recalibration, double score);
double quantile(const Mixture& belief, const Recalibration& recalibration, double p);

}  // namespace swingbank::train::posterior
