#pragma once
// Per-feature principal components, as in the thesis: every second of a channel (60 samples at 60/s) becomes
// its leading components (10), with one basis per channel.
#include <Eigen/Dense>
#include <span>
#include <vector>

#include "train/data/shard_stream.hpp"

namespace swingbank::train::data {

class Pca {
 public:
  /// Fits on `rows` only. Throws InputError if the rate is no whole number, the window no whole number of
  /// seconds, or there are fewer samples per second than components.
  static Pca fit(const ShardStream& stream, std::span<const std::uint64_t> rows, std::size_t components);

  [[nodiscard]] std::size_t components() const { return components_; }
  [[nodiscard]] std::size_t seconds() const { return seconds_; }
  [[nodiscard]] std::size_t per_second() const { return per_second_; }
  /// What was fitted, for a file: per channel mean and basis (column by column).
  [[nodiscard]] std::vector<std::vector<float>> arrays() const;
  /// The opposite, without error(). Throws Unusable if that does not fit together.
  static Pca restore(std::size_t components, std::size_t per_second, std::size_t samples,
                     std::span<const std::vector<float>> arrays);
  /// Length of a channel afterwards: seconds x components, a second's components side by side.
  [[nodiscard]] std::size_t length() const { return seconds_ * components_; }
  /// series: channels x samples of one row; out: channels x length().
  void apply(const float* series, float* out) const;
  /// The inverse, up to what was dropped.
  void reconstruct(const float* components, float* series) const;
  /// Share of the training rows' variance that the kept components do not reproduce, worst channel.
  [[nodiscard]] double error() const { return error_; }

 private:
  std::size_t components_ = 0, seconds_ = 0, per_second_ = 0;
  std::vector<Eigen::VectorXf> mean_;   ///< per channel: samples of a second
  std::vector<Eigen::MatrixXf> basis_;  ///< per channel: samples of a second x components
  double error_ = 0.0;
};

}  // namespace swingbank::train::data
