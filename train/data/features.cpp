#include "train/data/features.hpp"

#include "base/problem.hpp"
#include "base/sealed_file.hpp"

namespace swingbank::train::data {
namespace {
WhiteningSizes whitening_sizes(const FeatureSizes& s) {
  return {s.channels, s.samples, s.levels, s.pca_components, s.kept, s.noisy, s.regressed};
}
}  // namespace

Features Features::fit(const ShardStream& stream, std::span<const std::uint64_t> rows,
                       std::size_t pca_components) {
  if (stream.selection().physics) return of(Whitening::fit(stream, rows, pca_components));
  if (stream.selection().swing) return unchanged(stream.selection().values());
  Features f;
  f.channels_ = stream.channels();
  f.samples_ = f.length_ = stream.samples();
  if (pca_components > 0) {
    f.pca_ = Pca::fit(stream, rows, pca_components);
    f.length_ = f.pca_->length();
    f.groups_per_channel_ = pca_components;
    f.seconds_as_steps_ = stream.selection().seconds_as_steps;
  }
  const std::size_t groups = f.channels_ * f.groups_per_channel_;
  f.scale_ = {std::vector<float>(groups, 0.0f), std::vector<float>(groups, 1.0f)};
  GroupMoments moments(groups);
  constexpr std::size_t kRows = 1024;
  std::vector<float> series(kRows * f.channels_ * f.samples_), values(kRows * f.channels_ * f.length_);
  for (std::size_t begin = 0; begin < rows.size(); begin += kRows) {
    const std::size_t count = std::min(kRows, rows.size() - begin);
    stream.read(rows.subspan(begin, count), series.data());
    const std::size_t from = f.channels_ * f.samples_, to = f.channels_ * f.length_;
    for (std::size_t r = 0; r < count; ++r)  // applies only the PCA: the scale is still the identity
      f.scaled(series.data() + r * from, values.data() + r * to);
    for (std::size_t i = 0; i < count * f.channels_ * f.length_; ++i)
      moments.add(f.group(i / f.length_ % f.channels_, i % f.length_), values[i]);
  }
  Problems problems;
  for (std::size_t g = 0; g < groups; ++g) {
    f.scale_.mean[g] = static_cast<float>(moments.mean(g));
    const auto deviation = static_cast<float>(moments.deviation(g));
    if (deviation > 0.0f)
      f.scale_.deviation[g] = deviation;
    else if (!f.pca_)
      problems.add(
          "channel " +
              stream.dataset()
                  .channel_names[stream.selection().channels[g % stream.selection().channels.size()]] +
              " is constant",
          stream.dataset().path.string(), "its variance is 0, so it cannot be normalised",
          "leave it out of the experiment's channels");
  }
  problems.raise();
  return f;
}

Features Features::of(Whitening whitening) {
  Features f;
  f.channels_ = 1;
  f.samples_ = whitening.sizes().samples;
  f.length_ = whitening.length();
  f.whitening_ = std::move(whitening);
  return f;
}

Features Features::unchanged(std::size_t values) {
  Features f;
  f.channels_ = 1;
  f.samples_ = f.length_ = values;
  f.scale_ = {{0.0f}, {1.0f}};
  return f;
}

FeatureSizes Features::sizes() const {
  if (whitening_) {
    const WhiteningSizes& w = whitening_->sizes();
    return {w.channels, w.samples, w.components, 0, w.levels, w.kept, w.noisy, 0, w.regressed};
  }
  return {channels_, samples_, pca_ ? pca_->components() : 0, pca_ ? pca_->per_second() : 0, 0,
          0,         0,        seconds_as_steps_ ? 1u : 0u};
}

std::size_t Features::array_count(const FeatureSizes& s) {
  if (s.kept > 0) return Whitening::array_count(whitening_sizes(s));
  return 2 + (s.pca_components > 0 ? 2 * s.channels : 0);
}

std::vector<std::vector<float>> Features::arrays() const {
  if (whitening_) return whitening_->arrays();
  std::vector<std::vector<float>> all = {scale_.mean, scale_.deviation};
  if (pca_)
    for (auto& a : pca_->arrays()) all.push_back(std::move(a));
  return all;
}

Features Features::restore(const FeatureSizes& s, std::span<const std::vector<float>> arrays) {
  if (s.kept > 0) return of(Whitening::restore(whitening_sizes(s), arrays));
  Features f;
  f.channels_ = s.channels;
  f.samples_ = f.length_ = s.samples;
  if (arrays.size() != array_count(s)) throw Unusable{"its number of arrays differs"};
  if (s.pca_components > 0) {
    f.pca_ = Pca::restore(s.pca_components, s.pca_per_second, s.samples, arrays.subspan(2));
    f.length_ = f.pca_->length();
    f.groups_per_channel_ = s.pca_components;
    f.seconds_as_steps_ = s.seconds_as_steps > 0;
  }
  f.scale_ = {arrays[0], arrays[1]};
  for (const auto* a : {&f.scale_.mean, &f.scale_.deviation})
    if (a->size() != f.channels_ * f.groups_per_channel_) throw Unusable{"the length of an array differs"};
  return f;
}

void Features::apply(const float* series, std::size_t count, float* out) const {
  if (whitening_) return whitening_->apply(series, count, out);
  std::vector<float> by_channel(seconds_as_steps_ ? channels_ * length_ : 0);
  const std::size_t seconds = length(), components = groups_per_channel_;
  for (std::size_t r = 0; r < count; ++r) {
    float* row = out + r * channels_ * length_;
    scaled(series + r * channels_ * samples_, seconds_as_steps_ ? by_channel.data() : row);
    for (std::size_t i = 0; i < by_channel.size(); ++i) {
      const std::size_t channel = i / length_, second = i % length_ / components, component = i % components;
      row[(channel * components + component) * seconds + second] = by_channel[i];
    }
  }
}

void Features::scaled(const float* series, float* row) const {
  if (pca_)
    pca_->apply(series, row);
  else
    std::copy_n(series, channels_ * length_, row);
  for (std::size_t c = 0; c < channels_; ++c)
    for (std::size_t i = 0; i < length_; ++i) {
      const std::size_t g = group(c, i);
      float& value = row[c * length_ + i];
      value = (value - scale_.mean[g]) / scale_.deviation[g];
    }
}

}  // namespace swingbank::train::data
