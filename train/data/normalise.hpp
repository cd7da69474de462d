#pragma once
// Normalisation of inputs to zero mean and unit variance per group (a channel or PCA component), and scaling
// of targets. Both are fitted on training rows only.
#include <cstdint>
#include <span>
#include <vector>

namespace swingbank::train::data {

/// Mean and standard deviation of each group (divisor: the count). Sums are relative to the group's first
/// value, so that the deviation of a constant is exactly 0.
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

/// Scaling of targets. A target is divided by its standard deviation without subtracting the mean, because a
/// ReLU output cannot be negative. If the sampling box extends below zero (an exciter's lower ceiling), its
/// low end is subtracted first. A constant parameter is divided by its magnitude.
struct TargetScale {
  std::vector<double> mean;      ///< mean of the training targets, the baseline prediction [raw units]
  std::vector<double> unit;      ///< raw = scaled x unit + origin
  std::vector<double> origin;    ///< 0, or the box's low end if negative
  std::vector<double> variance;  ///< variance of the training targets [squared raw units]
  /// Fits the scale. values: all rows x parameters [raw units]; rows: training rows; low: low ends of the
  /// box; empty: none is negative.
  static TargetScale fit(const std::vector<double>& values, std::size_t parameters,
                         std::span<const std::uint64_t> rows, std::span<const double> low = {});
  /// Returns loss weights of the parameters' squared errors in scaled units: variance^power, normalised to
  /// mean 1. A constant parameter has weight 0 unless power is 0.
  [[nodiscard]] std::vector<float> weights(double power) const;
  [[nodiscard]] double scaled(double raw, std::size_t parameter) const {
    return (raw - origin[parameter]) / unit[parameter];
  }
  [[nodiscard]] double raw(double scaled, std::size_t parameter) const {
    return scaled * unit[parameter] + origin[parameter];
  }
};

}  // namespace swingbank::train::data
