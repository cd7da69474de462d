#include "train/posterior/coverage.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numeric>

#include "base/in_parallel.hpp"
#include "sim/core/noise.hpp"
#include "train/posterior/normal.hpp"

namespace swingbank::train::posterior {
namespace {

constexpr std::size_t kRankDraws = 199;  ///< number of posterior samples: 200 possible ranks, ten per bin
constexpr std::uint32_t kFactorStream = 0, kOwnStream = 1, kReferenceStream = 2;

std::size_t bin_of(double probability) {
  return std::min(static_cast<std::size_t>(probability * kRankBins), kRankBins - 1);
}

ParameterCoverage of_parameter(const Posteriors& posteriors, const Recalibration& recalibration,
                               std::span<const double> all_scores, std::size_t p) {
  ParameterCoverage c;
  const auto share = 1.0 / static_cast<double>(posteriors.rows);
  for (std::size_t r = 0; r < posteriors.rows; ++r) {
    const double below = normal_cdf(recalibration.recalibrated(all_scores[r * posteriors.parameters + p]));
    ++c.ranks.count[bin_of(below)];
    if (below > 0.25 && below < 0.75) c.within_50 += share;
    if (below > 0.05 && below < 0.95) c.within_90 += share;
    const Mixture& posterior = posteriors.of(r, p);
    c.width_50 +=
        share * (quantile(posterior, recalibration, 0.75) - quantile(posterior, recalibration, 0.25));
    c.width_90 +=
        share * (quantile(posterior, recalibration, 0.95) - quantile(posterior, recalibration, 0.05));
  }
  return c;
}

/// Draws one sample of a row's posterior, as positions in the box. `seed`: seed of the row.
void draw(const Posteriors& posteriors, std::span<const Recalibration> recalibrations, std::size_t row,
          std::uint64_t seed, std::size_t sample, std::span<double> out) {
  const double* F = posteriors.factor.data() + row * posteriors.parameters * kFactors;
  std::array<double, kFactors> common{};
  for (std::size_t k = 0; k < kFactors; k += 2) {
    const auto pair = sim::normal_pair(seed, kFactorStream, sample * kFactors + k);
    common[k] = pair[0];
    common[k + 1] = pair[1];
  }
  for (std::size_t p = 0; p < posteriors.parameters; ++p) {
    double sum = sim::normal_pair(seed, kOwnStream, sample * posteriors.parameters + p)[0], variance = 1.0;
    for (std::size_t k = 0; k < kFactors; ++k) {
      sum += F[p * kFactors + k] * common[k];
      variance += F[p * kFactors + k] * F[p * kFactors + k];
    }
    out[p] = quantile_of_score(posteriors.of(row, p), recalibrations[p], sum / std::sqrt(variance));
  }
}

double square_distance(std::span<const double> a, std::span<const double> b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

/// Returns the rank of the true value's distance from a random reference point among the distances of the
/// posterior samples.
std::size_t tarp_rank(const Posteriors& posteriors, std::span<const Recalibration> recalibrations,
                      std::size_t row, std::span<const double> truth, std::uint64_t seed) {
  std::vector<double> reference(truth.size()), sample(truth.size());
  for (std::size_t p = 0; p < truth.size(); ++p)
    reference[p] = sim::uniform_pair(seed, kReferenceStream, p)[0];
  const double distance = square_distance(truth, reference);
  std::size_t nearer = 0;
  for (std::size_t s = 0; s < kRankDraws; ++s) {
    draw(posteriors, recalibrations, row, seed, s, sample);
    if (square_distance(sample, reference) < distance) ++nearer;
  }
  return nearer;
}

}  // namespace

std::size_t Ranks::rows() const { return std::accumulate(count.begin(), count.end(), std::size_t{0}); }

double Ranks::chi_square() const {
  const double expected = static_cast<double>(rows()) / kRankBins;
  double sum = 0.0;
  for (const std::size_t n : count) sum += std::pow(static_cast<double>(n) - expected, 2.0) / expected;
  return sum;
}

double Ranks::by_chance() const {
  const boost::math::chi_squared distribution(kRankBins - 1);
  return boost::math::cdf(boost::math::complement(distribution, chi_square()));
}

double Ranks::largest_distance() const {
  double sum = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < kRankBins; ++i) {
    sum += static_cast<double>(count[i]) / static_cast<double>(rows());
    largest = std::max(largest, std::abs(sum - static_cast<double>(i + 1) / kRankBins));
  }
  return largest;
}

double Coverage::mean(double ParameterCoverage::*of) const {
  double sum = 0.0;
  for (const ParameterCoverage& p : parameters) sum += p.*of;
  return sum / static_cast<double>(parameters.size());
}

double quantile_of_score(const Mixture& posterior, const Recalibration& recalibration, double score) {
  constexpr double kFarthest = 6.0;  // largest score; a tail probability beyond it is rounding error
  return place_of_logit(
      posterior.quantile_of_score(std::clamp(recalibration.original(score), -kFarthest, kFarthest)));
}

double quantile(const Mixture& posterior, const Recalibration& recalibration, double p) {
  return quantile_of_score(posterior, recalibration, normal_quantile(p));
}

std::vector<double> scores(const Posteriors& posteriors, std::span<const double> places) {
  std::vector<double> all(places.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i] = normal_quantile(posteriors.marginal[i].cdf(logit_of_place(places[i])));
  return all;
}

Coverage coverage(const Posteriors& posteriors, std::span<const Recalibration> recalibrations,
                  std::span<const double> places, std::uint64_t seed) {
  const std::vector<double> all_scores = scores(posteriors, places);
  Coverage c;
  c.parameters.resize(posteriors.parameters);
  in_parallel(
      posteriors.parameters,
      [&](std::size_t p) { c.parameters[p] = of_parameter(posteriors, recalibrations[p], all_scores, p); },
      [](int) {});
  std::vector<std::size_t> rank(posteriors.rows);
  in_parallel(
      posteriors.rows,
      [&](std::size_t r) {
        rank[r] = tarp_rank(posteriors, recalibrations, r,
                            places.subspan(r * posteriors.parameters, posteriors.parameters),
                            sim::seed_of(~seed, r));  // not the random numbers of the noise of row r
      },
      [](int) {});
  for (const std::size_t r : rank) ++c.tarp.count[r * kRankBins / (kRankDraws + 1)];
  return c;
}

}  // namespace swingbank::train::posterior
