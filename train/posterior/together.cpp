#include "train/posterior/together.hpp"

#include <algorithm>
#include <cmath>

#include "train/posterior/normal.hpp"

namespace swingbank::train::posterior {
namespace {
constexpr std::size_t kPlaces = 512;    ///< number of grid points
constexpr double kFloorDensity = 1e-9;  ///< lower limit, so that no single record excludes a position

double place_at(std::size_t i) { return (static_cast<double>(i) + 0.5) / kPlaces; }

/// Adds the logarithm of the posterior density of the positions, on the grid.
void add_log_density(const Mixture& m, std::vector<double>& log_density) {
  for (std::size_t i = 0; i < kPlaces; ++i) {
    const double u = place_at(i), x = logit_of_place(u);
    double density = 0.0;
    for (std::size_t k = 0; k < kComponents; ++k)
      density += m.weight[k] / m.deviation[k] * normal_density((x - m.mean[k]) / m.deviation[k]);
    log_density[i] += std::log(density / (u * (1.0 - u)) + kFloorDensity);
  }
}
}  // namespace

std::vector<double> together(const Posteriors& posteriors, std::span<const std::size_t> rows) {
  std::vector<double> means;
  for (std::size_t p = 0; p < posteriors.parameters; ++p) {
    std::vector<double> log_density(kPlaces, 0.0);
    for (const std::size_t row : rows) add_log_density(posteriors.of(row, p), log_density);
    const double most = std::ranges::max(log_density);
    double sum = 0.0, weighted = 0.0;
    for (std::size_t i = 0; i < kPlaces; ++i) {
      const double weight = std::exp(log_density[i] - most);
      sum += weight;
      weighted += weight * place_at(i);
    }
    means.push_back(weighted / sum);
  }
  return means;
}

}  // namespace swingbank::train::posterior
