#pragma once
// Features: a network's input, computed from a record's series. The series are normalised, after an optional
// PCA of each second, or whitened (form "physics"), or unchanged (form "swing"). The transformation is fitted
// on training rows only.
#include <optional>
#include <span>

#include "train/data/normalise.hpp"
#include "train/data/pca.hpp"
#include "train/data/shard_stream.hpp"
#include "train/data/whitening.hpp"

namespace swingbank::train::data {

struct FeatureSizes {
  std::size_t channels = 0, samples = 0;
  std::size_t pca_components = 0, pca_per_second = 0;  ///< components, and samples of a second; 0: no PCA
  std::size_t levels = 0, kept = 0, noisy = 0;         ///< WhiteningSizes; kept = 0: no whitening
  std::size_t seconds_as_steps = 0;  ///< 1: the components of each second form one time step
  std::size_t regressed = 0;         ///< WhiteningSizes: number of regression coefficients
};

class Features {
 public:
  /// Fits the features on `rows`. pca_components = 0: no PCA. Series are normalised per channel; with PCA,
  /// per channel and component. The form "physics" is whitened, with pca_components components per channel.
  /// The form "swing" is not changed. Without PCA and whitening, throws InputError if a channel is constant
  /// over the rows.
  static Features fit(const ShardStream& stream, std::span<const std::uint64_t> rows,
                      std::size_t pca_components);

  /// Returns the number of channels of the input. A whitened row is one channel. With seconds as steps, each
  /// component of each channel becomes a channel.
  [[nodiscard]] std::size_t channels() const {
    return seconds_as_steps_ ? channels_ * groups_per_channel_ : channels_;
  }
  [[nodiscard]] std::size_t length() const {
    return seconds_as_steps_ ? length_ / groups_per_channel_ : length_;
  }
  [[nodiscard]] const std::optional<Pca>& pca() const { return pca_; }
  [[nodiscard]] const Scale& scale() const { return scale_; }
  /// Return the fitted state for a file: sizes(), and arrays() in the order that `restore` expects.
  [[nodiscard]] FeatureSizes sizes() const;
  [[nodiscard]] std::vector<std::vector<float>> arrays() const;
  /// Restores features from a file. Throws Unusable if sizes and arrays do not match.
  static Features restore(const FeatureSizes& sizes, std::span<const std::vector<float>> arrays);
  /// Returns the number of arrays that `restore` takes for these sizes.
  static std::size_t array_count(const FeatureSizes& sizes);
  /// Computes features. series: `count` rows from the stream; out: count x channels() x length().
  void apply(const float* series, std::size_t count, float* out) const;

 private:
  static Features of(Whitening whitening);
  /// Returns features that pass the values of a row unchanged, as one channel.
  static Features unchanged(std::size_t values);
  /// Computes the normalised series of one row, channel after channel.
  void scaled(const float* series, float* row) const;
  [[nodiscard]] std::size_t group(std::size_t channel, std::size_t i) const {
    return channel * groups_per_channel_ + i % groups_per_channel_;
  }

  std::size_t channels_ = 0, samples_ = 0, length_ = 0, groups_per_channel_ = 1;
  bool seconds_as_steps_ = false;
  std::optional<Pca> pca_;
  std::optional<Whitening> whitening_;
  Scale scale_;
};

}  // namespace swingbank::train::data
