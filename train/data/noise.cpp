#include "train/data/noise.hpp"

#include <array>
#include <optional>
#include <string_view>

#include "base/problem.hpp"
#include "sim/core/channel.hpp"
#include "sim/core/noise.hpp"

namespace swingbank::train::data {

sim::FrequencyFilter frequency_filter(const mpi::store::DatasetHeader& dataset) {
  const auto given = mpi::store::config_numbers(dataset, "record.frequency");
  return given.size() == 2 ? sim::FrequencyFilter{given[0], given[1]} : sim::FrequencyFilter{};
}

RecordNoise::RecordNoise(const mpi::store::DatasetHeader& dataset, const NoiseRecipe& recipe)
    : recipe_(recipe),
      noise_{recipe.level},
      samples_(dataset.samples),
      rate_(dataset.rate),
      system_frequency_(dataset.frequency),
      filter_(frequency_filter(dataset)) {
  if (none()) return;
  Problems problems;
  const auto known = [](std::string_view name) -> std::optional<Noisy> {
    using sim::Channel;
    const auto key = [](Channel c) { return static_cast<std::uint32_t>(c); };
    if (name == "frequency") return Noisy{Kind::frequency, key(Channel::theta)};
    const auto* record = sim::find_channel(name);
    if (!record) return {};
    switch (record->channel) {
      case Channel::P:
      case Channel::Q:
      case Channel::V:
      case Channel::theta:
        return Noisy{Kind::phasor, key(record->channel)};
      case Channel::Ifd:
      case Channel::Efd:
        return Noisy{Kind::field, key(record->channel)};
      case Channel::speed:
        return Noisy{Kind::speed, key(record->channel)};
      default:
        return {};
    }
  };
  for (const std::string& name : dataset.channel_names) {
    const auto channel = known(name);
    if (!channel)
      problems.add("no noise is known of channel " + name, dataset.name.empty() ? "dataset" : dataset.name,
                   "no instrument at a terminal shows it", "read this dataset without noise");
    channels_.push_back(channel.value_or(Noisy{}));
    if (channel && channel->kind == Kind::frequency && system_frequency_ <= 0)
      problems.add("no system frequency", dataset.name.empty() ? "dataset.json" : dataset.name,
                   "an older version of the software made the dataset", "make it again in an empty folder");
  }
  problems.raise();
}

void RecordNoise::add_to(std::uint64_t row, const Noisy& channel, float* samples) const {
  const std::uint64_t seed = sim::seed_of(recipe_.seed, row);
  std::vector<double> drawn(samples_);
  for (std::size_t k = 0; k < samples_; k += 2) {
    const auto pair = sim::normal_pair(seed, channel.key, k / 2);
    drawn[k] = pair[0];
    if (k + 1 < samples_) drawn[k + 1] = pair[1];
  }
  if (channel.kind == Kind::frequency) {
    for (double& n : drawn) n *= noise_.phasor();
    const std::vector<double> theta = drawn;
    sim::terminal_frequency(theta.data(), samples_, rate_, system_frequency_, filter_, drawn.data());
  }
  for (std::size_t k = 0; k < samples_; ++k) {
    const double value = samples[k];
    double deviation = 1;
    if (channel.kind == Kind::phasor) deviation = noise_.phasor();
    if (channel.kind == Kind::field) deviation = noise_.field(value);
    if (channel.kind == Kind::speed) deviation = noise_.speed();
    samples[k] = static_cast<float>(value + deviation * drawn[k]);
  }
}

void RecordNoise::add(std::uint64_t row, float* record) const {
  for (std::size_t c = 0; c < channels_.size(); ++c) add_to(row, channels_[c], record + c * samples_);
}

}  // namespace swingbank::train::data
