#include "train/data/noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "base/problem.hpp"
#include "sim/core/channel.hpp"
#include "sim/core/noise.hpp"
#include "train/data/random.hpp"

namespace swingbank::train::data {
namespace {
constexpr std::size_t kStore = std::size_t{1} << 20;  ///< stored normal numbers; they fit into the cache
constexpr double kZeroLevel = 1e-5, kMiddleLevel = 1e-3;

double unit_interval(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }
}  // namespace

float level_input(double level) {
  return static_cast<float>(0.5 * std::log((level + kZeroLevel) / kMiddleLevel));
}
double level_of_input(float input) {
  return std::max(0.0, kMiddleLevel * std::exp(2.0 * static_cast<double>(input)) - kZeroLevel);
}

sim::FrequencyFilter frequency_filter(const mpi::store::DatasetHeader& dataset) {
  const auto given = mpi::store::config_numbers(dataset, "record.frequency");
  return given.size() == 2 ? sim::FrequencyFilter{given[0], given[1]} : sim::FrequencyFilter{};
}

RecordNoise::RecordNoise(const mpi::store::DatasetHeader& dataset, const NoiseRecipe& recipe)
    : recipe_(recipe),
      samples_(dataset.samples),
      rate_(dataset.rate),
      system_frequency_(dataset.frequency),
      filter_(frequency_filter(dataset)) {
  if (none() && !recipe.training) return;
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
      problems.add("no noise model of channel " + name, dataset.name.empty() ? "dataset" : dataset.name,
                   "the noise model covers measured channels only",
                   "leave out --noise and training_noise, or generate the dataset without this channel");
    channels_.push_back(channel.value_or(Noisy{}));
    if (channel && channel->kind == Kind::frequency && system_frequency_ <= 0)
      problems.add("no system frequency", dataset.name.empty() ? "dataset.json" : dataset.name,
                   "an older version of Swingbank generated the dataset",
                   "generate it again in an empty folder");
  }
  problems.raise();
  if (!recipe.training) return;
  store_.reserve(kStore);
  const std::uint64_t seed = key(recipe.seed, Purpose::noise);
  for (std::size_t k = 0; k < kStore / 2; ++k)
    for (const double n : sim::normal_pair(seed, 0, k)) store_.push_back(static_cast<float>(n));
}

double RecordNoise::level(std::uint64_t row, const Noise& noise) const {
  if (noise.level) return *noise.level;
  const NoiseLevels& range = *recipe_.training;
  const std::uint64_t of_row = key(recipe_.seed, Purpose::noise_level, row, noise.draw);
  if (unit_interval(of_row) < range.share_at_zero) return 0;
  return range.low * std::pow(range.high / range.low, unit_interval(mix(of_row)));
}

void RecordNoise::draw_new(std::uint64_t row, const Noisy& channel, std::uint64_t draw, double* out) const {
  const std::uint64_t of_draw = draw == 0 ? recipe_.seed : key(recipe_.seed, Purpose::noise, draw);
  const std::uint64_t seed = sim::seed_of(of_draw, row);
  for (std::size_t k = 0; k < samples_; k += 2) {
    const auto pair = sim::normal_pair(seed, channel.key, k / 2);
    out[k] = pair[0];
    if (k + 1 < samples_) out[k + 1] = pair[1];
  }
}

void RecordNoise::draw_from_store(std::uint64_t row, const Noisy& channel, std::uint64_t draw,
                                  double* out) const {
  const std::uint64_t place = mix(key(recipe_.seed, Purpose::noise, row, draw) ^ channel.key);
  const double sign = place >> 63 ? -1.0 : 1.0;
  for (std::size_t k = 0; k < samples_; ++k) out[k] = sign * store_[(place + k) % kStore];
}

void RecordNoise::add_to(const Noisy& channel, double level, std::vector<double>& drawn,
                         float* samples) const {
  const sim::MeasurementNoise noise{level};
  if (channel.kind == Kind::frequency) {
    for (double& n : drawn) n *= noise.phasor();
    const std::vector<double> theta = drawn;
    sim::terminal_frequency(theta.data(), samples_, rate_, system_frequency_, filter_, drawn.data());
  }
  for (std::size_t k = 0; k < samples_; ++k) {
    const double value = samples[k];
    double deviation = 1;
    if (channel.kind == Kind::phasor) deviation = noise.phasor();
    if (channel.kind == Kind::field) deviation = noise.field(value);
    if (channel.kind == Kind::speed) deviation = noise.speed();
    samples[k] = static_cast<float>(value + deviation * drawn[k]);
  }
}

void RecordNoise::add(std::uint64_t row, const Noise& noise, float* record) const {
  const double of_row = level(row, noise);
  if (of_row == 0) return;
  std::vector<double> drawn(samples_);
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    if (noise.level)
      draw_new(row, channels_[c], noise.draw, drawn.data());
    else
      draw_from_store(row, channels_[c], noise.draw, drawn.data());
    add_to(channels_[c], of_row, drawn, record + c * samples_);
  }
}

}  // namespace swingbank::train::data
