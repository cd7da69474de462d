#pragma once
// Power law y = c x^b by least squares of the logarithms, with 95 % intervals (Student's t).
#include <optional>
#include <utility>
#include <vector>

namespace swingbank::validate::report {

using Interval = std::pair<double, double>;

class PowerLaw {
 public:
  /// Needs at least three points, all above 0, with at least two different x.
  explicit PowerLaw(const std::vector<std::pair<double, double>>& points);
  [[nodiscard]] double exponent() const { return slope_; }
  [[nodiscard]] Interval exponent_interval() const;
  [[nodiscard]] double at(double x) const;
  /// Confidence interval of the law at x, not of a single point.
  [[nodiscard]] Interval interval(double x) const;
  /// Returns x at which the law reaches y.
  [[nodiscard]] double reaches(double y) const;
  /// Returns the interval of x in which the law's interval contains y (Fieller); none if the exponent does
  /// not differ significantly from 0.
  [[nodiscard]] std::optional<Interval> reaches_interval(double y) const;

 private:
  double n_ = 0, x_ = 0, y_ = 0, xx_ = 0;  // number, means, sum of squares about the mean
  double slope_ = 0, reach_ = 0;           // reach: Student's quantile * standard deviation about the law
};

}  // namespace swingbank::validate::report
