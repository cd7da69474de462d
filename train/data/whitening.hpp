#pragma once
// Transformation of series to a short row of uncorrelated numbers of equal variance. Each channel is divided
// by the row's size, the root mean square of the first channel. The principal components of all channels are
// whitened together. If rows have different noise levels, the whitened numbers are rotated until their noise
// is uncorrelated, and multiplied by the signal's share of the variance at the row's noise level. All are
// then compressed by asinh. Fitted on training rows only.
#include <Eigen/Dense>
#include <span>
#include <vector>

#include "train/data/shard_stream.hpp"

namespace swingbank::train::data {

/// Sizes of a whitening: channels, samples per channel, values after the series (`levels`), components per
/// channel, kept components in total. `noisy`: 1 if the noise level is the last value, else 0. `regressed`:
/// number of regression coefficients.
struct WhiteningSizes {
  std::size_t channels = 0, samples = 0, levels = 0, components = 0, kept = 0, noisy = 0, regressed = 0;
};

class Whitening {
 public:
  /// Fits on `rows`, or on a sufficient number of them, drawn at random. Throws InputError for no components
  /// or for more components than samples.
  static Whitening fit(const ShardStream& stream, std::span<const std::uint64_t> rows,
                       std::size_t components);

  [[nodiscard]] const WhiteningSizes& sizes() const { return sizes_; }
  /// Returns the length of a transformed row. It consists of the whitened numbers, the scaled steady values,
  /// the logarithm of the size and the encoded noise level. Regression coefficients follow, relative to their
  /// medians and widths.
  [[nodiscard]] std::size_t length() const {
    return sizes_.kept + sizes_.levels + 1 + sizes_.noisy + sizes_.regressed;
  }
  /// Transforms rows. series: `count` rows of channels x samples + levels + noisy values; out: count x
  /// length().
  void apply(const float* series, std::size_t count, float* out) const;
  /// Return the fitted state for a file, and restore it from one. restore() throws Unusable if the sizes do
  /// not match.
  [[nodiscard]] std::vector<std::vector<float>> arrays() const;
  static Whitening restore(const WhiteningSizes& sizes, std::span<const std::vector<float>> arrays);
  static std::size_t array_count(const WhiteningSizes& sizes) {
    return 2 * sizes.channels + 3 + sizes.noisy + (sizes.regressed > 0 ? 3 : 0);
  }

 private:
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  /// Returns the components of all channels, the steady values and the logarithm of the size, before
  /// whitening.
  [[nodiscard]] Rows components(const float* series, std::size_t count) const;
  void fit_bases(const Rows& series);
  void fit_whole(const Rows& components);
  /// Rotates the whitened numbers until their noise is uncorrelated. `clean`, `noisy`: series of the same
  /// rows without and with noise.
  void fit_noise(const Rows& clean, const Rows& noisy);
  /// Computes the median and width of each regression coefficient over the rows.
  void fit_regressions(const Rows& series, std::vector<float> weights);
  void apply_regressions(const float* series, float* out) const;
  /// Returns the whitened numbers before the compression by asinh.
  [[nodiscard]] Rows whitened(const Rows& components) const;

  WhiteningSizes sizes_;
  std::vector<Eigen::RowVectorXf> mean_;  ///< per channel
  std::vector<Eigen::MatrixXf> basis_;    ///< per channel: samples x components
  Eigen::RowVectorXf centre_, unit_;      ///< mean and standard deviation of the components
  Eigen::MatrixXf whole_;                 ///< (components of all channels, levels, size) x kept
  Eigen::RowVectorXf noise_;              ///< standard deviation of the numbers' noise if level / size = 1
  std::vector<float> weights_, median_, width_;  ///< weights of samples; scale of coefficients
};

}  // namespace swingbank::train::data
