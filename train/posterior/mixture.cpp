#include "train/posterior/mixture.hpp"

#include <algorithm>
#include <cmath>

#include "train/posterior/normal.hpp"

namespace swingbank::train::posterior {

double Mixture::cdf(double x) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < kComponents; ++k) sum += weight[k] * normal_cdf((x - mean[k]) / deviation[k]);
  return sum;
}

double Mixture::quantile_of_score(double score) const {
  const double p = normal_cdf(score);
  double low = mean[0] + deviation[0] * score, high = low;
  for (std::size_t k = 1; k < kComponents; ++k) {
    low = std::min(low, mean[k] + deviation[k] * score);
    high = std::max(high, mean[k] + deviation[k] * score);
  }
  // The mixture's quantile lies between those of its components. Newton's method, with bisection if a step
  // would leave that interval.
  double x = 0.5 * (low + high);
  for (int i = 0; i < 60; ++i) {
    double below = 0.0, density = 0.0;
    for (std::size_t k = 0; k < kComponents; ++k) {
      const double z = (x - mean[k]) / deviation[k];
      below += weight[k] * normal_cdf(z);
      density += weight[k] / deviation[k] * normal_density(z);
    }
    (below < p ? low : high) = x;
    double next = x - (below - p) / density;
    if (!(next > low && next < high)) next = 0.5 * (low + high);  // also for zero density
    const double step = std::abs(next - x);
    x = next;
    if (step <= 1e-9 * (1.0 + std::abs(x))) break;
  }
  return x;
}

double logit_of_place(double place) {
  constexpr double kEnd = 1e-5;
  const double inside = std::clamp(place, kEnd, 1.0 - kEnd);
  return std::log(inside / (1.0 - inside));
}

double place_of_logit(double logit) { return 1.0 / (1.0 + std::exp(-logit)); }

}  // namespace swingbank::train::posterior
