#pragma once
// Series to a short row of numbers that are uncorrelated and of one size: each channel over the row's own
// size, principal components per channel, all of them whitened together, and a soft bound. Where rows have
// noise of many levels, the numbers are turned until their noise is uncorrelated too, and each shrinks by
// what the row's level leaves of it. Fitted on training rows only.
#include <Eigen/Dense>
#include <span>
#include <vector>

#include "train/data/shard_stream.hpp"

namespace swingbank::train::data {

/// Lengths: channels, samples of a channel, values behind the series; components kept of a channel and of
/// all. `noisy`: the noise's level stands behind them (0 or 1). `regressed`: coefficients of regressions.
struct WhiteningSizes {
  std::size_t channels = 0, samples = 0, levels = 0, components = 0, kept = 0, noisy = 0, regressed = 0;
};

class Whitening {
 public:
  /// Fits on `rows`, or on as many of them as settle the components. The row's size is the root mean square
  /// of the first channel. Throws InputError for more components than samples.
  static Whitening fit(const ShardStream& stream, std::span<const std::uint64_t> rows,
                       std::size_t components);

  [[nodiscard]] const WhiteningSizes& sizes() const { return sizes_; }
  /// Numbers a row becomes: the whitened ones, then levels and logarithm of the size as they are, the noise's
  /// level as it is told, and the regressions' coefficients about their medians, bounded.
  [[nodiscard]] std::size_t length() const {
    return sizes_.kept + sizes_.levels + 1 + sizes_.noisy + sizes_.regressed;
  }
  /// series: count rows of channels x samples + levels + noisy values; out: count x length().
  void apply(const float* series, std::size_t count, float* out) const;
  /// What was fitted, for a file, and the opposite. Throws Unusable if that does not fit together.
  [[nodiscard]] std::vector<std::vector<float>> arrays() const;
  static Whitening restore(const WhiteningSizes& sizes, std::span<const std::vector<float>> arrays);
  static std::size_t array_count(const WhiteningSizes& sizes) {
    return 2 * sizes.channels + 3 + sizes.noisy + (sizes.regressed > 0 ? 3 : 0);
  }

 private:
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  /// Components of all channels, levels, logarithm of the size: before they are whitened.
  [[nodiscard]] Rows components(const float* series, std::size_t count) const;
  void fit_bases(const Rows& series);
  void fit_whole(const Rows& components);
  /// Turns the whitened numbers until their noise is uncorrelated. `clean`, `noisy`: the same rows' series.
  void fit_noise(const Rows& clean, const Rows& noisy);
  /// Middle and width of each coefficient over the rows.
  void fit_regressions(const Rows& series, std::vector<float> weights);
  void apply_regressions(const float* series, float* out) const;
  /// The whitened numbers without their bound.
  [[nodiscard]] Rows whitened(const Rows& components) const;

  WhiteningSizes sizes_;
  std::vector<Eigen::RowVectorXf> mean_;         ///< per channel
  std::vector<Eigen::MatrixXf> basis_;           ///< per channel: samples x components
  Eigen::RowVectorXf centre_, unit_;             ///< of the components
  Eigen::MatrixXf whole_;                        ///< components of all channels and levels x kept
  Eigen::RowVectorXf noise_;                     ///< deviation of the whitened at a level of the row's size
  std::vector<float> weights_, median_, width_;  ///< of the samples; of the regressions' coefficients
};

}  // namespace swingbank::train::data
