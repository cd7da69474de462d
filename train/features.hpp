#pragma once
// From a record's series to what the network reads: optional PCA, then normalisation. Fitted on training rows
// only.
#include <optional>
#include <span>

#include "train/normalise.hpp"
#include "train/pca.hpp"
#include "train/shard_stream.hpp"

namespace swingbank {

class Features {
 public:
  /// pca_components = 0: no PCA. Series are normalised per channel, components per channel and component.
  /// Throws InputError if a channel is constant over the training rows.
  static Features fit(const ShardStream& stream, std::span<const std::uint64_t> rows,
                      std::size_t pca_components);

  [[nodiscard]] std::size_t channels() const { return channels_; }
  [[nodiscard]] std::size_t length() const { return length_; }
  [[nodiscard]] const std::optional<Pca>& pca() const { return pca_; }
  [[nodiscard]] const Scale& scale() const { return scale_; }
  /// series: count x channels x samples; out: count x channels x length().
  void apply(const float* series, std::size_t count, float* out) const;

 private:
  [[nodiscard]] std::size_t group(std::size_t channel, std::size_t i) const {
    return channel * groups_per_channel_ + i % groups_per_channel_;
  }

  std::size_t channels_ = 0, samples_ = 0, length_ = 0, groups_per_channel_ = 1;
  std::optional<Pca> pca_;
  Scale scale_;
};

}  // namespace swingbank
