#include "validate/report/detail/power_law.hpp"

#include <array>
#include <cmath>
#include <cstddef>

#include "base/constants.hpp"

namespace swingbank::validate::report {
namespace {

/// Returns the two-sided 95 % quantile of Student's t distribution.
double student95(std::size_t freedom) {
  static constexpr std::array<double, 10> kQuantiles = {12.706, 4.303, 3.182, 2.776, 2.571,
                                                        2.447,  2.365, 2.306, 2.262, 2.228};
  if (freedom <= kQuantiles.size()) return kQuantiles.at(freedom - 1);
  const double z = constants::normal95, v = static_cast<double>(freedom);
  return z + (z * z * z + z) /
                 (4 * v);  // first Cornish-Fisher term: 2.195 for 11 degrees of freedom (exact: 2.201)
}

}  // namespace

PowerLaw::PowerLaw(const std::vector<std::pair<double, double>>& points) {
  n_ = static_cast<double>(points.size());
  for (const auto& [x, y] : points) x_ += std::log(x) / n_, y_ += std::log(y) / n_;
  double xy = 0;
  for (const auto& [x, y] : points) {
    xx_ += std::pow(std::log(x) - x_, 2);
    xy += (std::log(x) - x_) * (std::log(y) - y_);
  }
  slope_ = xy / xx_;
  double left = 0;
  for (const auto& [x, y] : points) left += std::pow(std::log(y) - std::log(at(x)), 2);
  reach_ = student95(points.size() - 2) * std::sqrt(left / (n_ - 2));
}

Interval PowerLaw::exponent_interval() const {
  const double half = reach_ / std::sqrt(xx_);
  return {slope_ - half, slope_ + half};
}
double PowerLaw::at(double x) const { return std::exp(y_ + slope_ * (std::log(x) - x_)); }
Interval PowerLaw::interval(double x) const {
  const double half = reach_ * std::sqrt(1 / n_ + std::pow(std::log(x) - x_, 2) / xx_);
  return {at(x) * std::exp(-half), at(x) * std::exp(half)};
}
double PowerLaw::reaches(double y) const { return std::exp(x_ + (std::log(y) - y_) / slope_); }
std::optional<Interval> PowerLaw::reaches_interval(double y) const {
  const double up = std::log(y) - y_, a = slope_ * slope_ - reach_ * reach_ / xx_;
  if (a <= 0) return std::nullopt;
  const double half =
      std::sqrt(std::max(0.0, std::pow(slope_ * up, 2) - a * (up * up - reach_ * reach_ / n_)));
  return Interval{std::exp(x_ + (slope_ * up - half) / a), std::exp(x_ + (slope_ * up + half) / a)};
}

}  // namespace swingbank::validate::report
