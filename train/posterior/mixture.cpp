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

double Mixture::quantile(double p) const {
  const double z = normal_quantile(p);
  double low = mean[0] + deviation[0] * z, high = low;
  for (std::size_t k = 1; k < kComponents; ++k) {
    low = std::min(low, mean[k] + deviation[k] * z);
    high = std::max(high, mean[k] + deviation[k] * z);
  }
  // the mixture's quantile lies between those of its components
  for (int i = 0; i < 60 && high - low > 1e-9 * (1.0 + std::abs(low)); ++i) {
    const double middle = 0.5 * (low + high);
    (cdf(middle) < p ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double logit_of_place(double place) {
  constexpr double kEnd = 1e-5;
  const double inside = std::clamp(place, kEnd, 1.0 - kEnd);
  return std::log(inside / (1.0 - inside));
}

double place_of_logit(double logit) { return 1.0 / (1.0 + std::exp(-logit)); }

}  // namespace swingbank::train::posterior
