#include "train/data/normalise.hpp"

#include <algorithm>
#include <cmath>

namespace swingbank::train::data {

double GroupMoments::deviation(std::size_t group) const {
  const double m = sum_[group] / count_[group];
  return std::sqrt(std::max(0.0, square_[group] / count_[group] - m * m));
}

TargetScale TargetScale::fit(const std::vector<double>& values, std::size_t parameters,
                             std::span<const std::uint64_t> rows, std::span<const double> low) {
  GroupMoments moments(parameters);
  for (const std::uint64_t row : rows)
    for (std::size_t p = 0; p < parameters; ++p) moments.add(p, values[row * parameters + p]);
  TargetScale scale;
  for (std::size_t p = 0; p < parameters; ++p) {
    const double mean = moments.mean(p), deviation = moments.deviation(p), magnitude = std::abs(mean);
    scale.mean.push_back(mean);
    scale.origin.push_back(low.empty() ? 0.0 : std::min(0.0, low[p]));
    scale.variance.push_back(deviation * deviation);
    scale.unit.push_back(deviation > 0.0 ? deviation : magnitude > 0.0 ? magnitude : 1.0);
  }
  return scale;
}

std::vector<float> TargetScale::weights(double power) const {
  std::vector<float> all;
  double sum = 0.0;
  for (const double v : variance) sum += power == 0.0 ? 1.0 : std::pow(v, power);
  for (const double v : variance)
    all.push_back(static_cast<float>((power == 0.0 ? 1.0 : std::pow(v, power)) *
                                     static_cast<double>(variance.size()) / sum));
  return all;
}

}  // namespace swingbank::train::data
