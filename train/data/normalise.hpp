#pragma once
// Zero mean and unit variance per group of inputs, and the scale of the targets; both fitted on training rows
// only.
#include <cstdint>
#include <span>
#include <vector>

namespace swingbank::train::data {

/// Sums values group by group, then gives mean and standard deviation (dividing by the count). Sums are taken
/// about each group's first value, so that a constant has a deviation of exactly 0.
class GroupMoments {
 public:
  explicit GroupMoments(std::size_t groups) : first_(groups), sum_(groups), square_(groups), count_(groups) {}
  void add(std::size_t group, double value) {
    if (count_[group] == 0.0) first_[group] = value;
    const double x = value - first_[group];
    sum_[group] += x;
    square_[group] += x * x;
    count_[group] += 1.0;
  }
  [[nodiscard]] double mean(std::size_t group) const { return first_[group] + sum_[group] / count_[group]; }
  [[nodiscard]] double deviation(std::size_t group) const;

 private:
  std::vector<double> first_, sum_, square_, count_;
};

/// x' = (x - mean) / deviation.
struct Scale {
  std::vector<float> mean, deviation;
};

/// Targets are divided by their standard deviation and not shifted, so that zero stays zero and the network's
/// ReLU output keeps its meaning (a parameter is not negative). Where the box reaches below zero (an
/// exciter's lower ceiling), its low end takes the place of zero. A constant parameter is divided by its
/// magnitude.
struct TargetScale {
  std::vector<double> mean;      ///< of the training targets, raw units: the predict-the-mean baseline
  std::vector<double> unit;      ///< raw = scaled x unit + origin
  std::vector<double> origin;    ///< 0, or the box's low end below it
  std::vector<double> variance;  ///< of the training targets, raw units
  /// values: all rows x parameters, raw units; rows: training rows; low: of the box (empty: none is
  /// negative).
  static TargetScale fit(const std::vector<double>& values, std::size_t parameters,
                         std::span<const std::uint64_t> rows, std::span<const double> low = {});
  /// For the squared errors of scaled parameters: variance to the `power`, mean 1; 0 for one that is
  /// constant, unless power is 0.
  [[nodiscard]] std::vector<float> weights(double power) const;
  [[nodiscard]] double scaled(double raw, std::size_t parameter) const {
    return (raw - origin[parameter]) / unit[parameter];
  }
  [[nodiscard]] double raw(double scaled, std::size_t parameter) const {
    return scaled * unit[parameter] + origin[parameter];
  }
};

}  // namespace swingbank::train::data
