#pragma once
// Principal component analysis (PCA) of each channel, as in the thesis: each second of a channel (60 samples
// at 60/s) is replaced by its 10 leading components. Each channel has one basis.
#include <Eigen/Dense>
#include <span>
#include <vector>

#include "train/data/shard_stream.hpp"

namespace swingbank::train::data {

class Pca {
 public:
  /// Fits on `rows` only. Throws InputError if the rate is not an integer, the window is not a whole number
  /// of seconds, or a second has fewer samples than components.
  static Pca fit(const ShardStream& stream, std::span<const std::uint64_t> rows, std::size_t components);

  [[nodiscard]] std::size_t components() const { return components_; }
  [[nodiscard]] std::size_t seconds() const { return seconds_; }
  [[nodiscard]] std::size_t per_second() const { return per_second_; }
  /// Returns the fitted state for a file: mean and basis (column by column) of each channel.
  [[nodiscard]] std::vector<std::vector<float>> arrays() const;
  /// Restores the state from a file, except error(). Throws Unusable if the sizes do not match.
  static Pca restore(std::size_t components, std::size_t per_second, std::size_t samples,
                     std::span<const std::vector<float>> arrays);
  /// Returns the length of a transformed channel: seconds x components, a second's components contiguous.
  [[nodiscard]] std::size_t length() const { return seconds_ * components_; }
  /// Transforms one row. series: channels x samples; out: channels x length().
  void apply(const float* series, float* out) const;
  /// Inverse of apply(), up to the dropped components.
  void reconstruct(const float* components, float* series) const;
  /// Returns the share of the training rows' variance that the kept components do not reproduce, for the
  /// worst channel.
  [[nodiscard]] double error() const { return error_; }

 private:
  std::size_t components_ = 0, seconds_ = 0, per_second_ = 0;
  std::vector<Eigen::VectorXf> mean_;   ///< per channel: samples of a second
  std::vector<Eigen::MatrixXf> basis_;  ///< per channel: samples of a second x components
  double error_ = 0.0;
};

}  // namespace swingbank::train::data
