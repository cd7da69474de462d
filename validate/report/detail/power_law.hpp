#pragma once
// A power law y = c x^b through points, by least squares on the logarithms, with Student's intervals of 95 %.
#include <optional>
#include <utility>
#include <vector>

namespace swingbank::validate::report {

using Interval = std::pair<double, double>;

class PowerLaw {
 public:
  /// At least three points, all above 0, of at least two different x.
  explicit PowerLaw(const std::vector<std::pair<double, double>>& points);
  [[nodiscard]] double exponent() const { return slope_; }
  [[nodiscard]] Interval exponent_interval() const;
  [[nodiscard]] double at(double x) const;
  /// Of the law at x, not of a single point.
  [[nodiscard]] Interval interval(double x) const;
  /// The x at which the law reaches y.
  [[nodiscard]] double reaches(double y) const;
  /// The x at which the law's interval holds y (Fieller); none where a slope of 0 cannot be ruled out.
  [[nodiscard]] std::optional<Interval> reaches_interval(double y) const;

 private:
  double n_ = 0, x_ = 0, y_ = 0, xx_ = 0;  // number, means, sum of squares about the mean
  double slope_ = 0, reach_ = 0;           // reach: Student's quantile times the scatter about the law
};

}  // namespace swingbank::validate::report
