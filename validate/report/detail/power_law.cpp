#include "validate/report/detail/power_law.hpp"

#include <boost/math/distributions/students_t.hpp>
#include <cmath>

namespace swingbank::validate::report {
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
  const boost::math::students_t student(n_ - 2);
  reach_ = boost::math::quantile(student, 0.975) * std::sqrt(left / (n_ - 2));
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
