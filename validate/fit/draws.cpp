#include "validate/fit/draws.hpp"

#include <algorithm>
#include <cmath>

#include "sim/core/noise.hpp"
#include "sim/plant/usual.hpp"
#include "validate/fit/sign.hpp"
#include "validate/playin/can_run.hpp"

namespace swingbank::validate::fit {
namespace {

/// Maximum number of tries per draw.
constexpr std::uint64_t kRedraws = 20;
/// Standard deviation of ln(value), in prior standard deviations. kIndependentWidth: in draws with an even
/// number. kGainWidth: of gains in odd draws, which are uncertain by decades. kOrderedWidth: of other
/// parameters in odd draws.
constexpr double kIndependentWidth = 1.2, kGainWidth = 2.0, kOrderedWidth = 0.8;
/// Share of values that are reduced, and their largest reduction [decades]. The reduction factor is
/// log-uniform.
constexpr double kShareOfReduced = 0.25, kDecadesBelow = 2;
/// Lower limit of the longest time constant, relative to the length of the records.
constexpr double kShortestDraw = 3e-3;

/// Random streams of one parameter. The stream `whole` serves the whole draw and uses the number of the first
/// parameter.
enum Stream : std::uint32_t { own, common, reduced, whole, streams };

std::uint32_t stream(std::size_t parameter, Stream which) {
  return static_cast<std::uint32_t>(parameter) * streams + which;
}

bool is_time(const sim::Parameter& p) { return p.unit == "s"; }

}  // namespace

Draws::Draws(sim::plant::Plant plant, std::vector<FreeParameter> free, std::uint64_t stream, double length)
    : plant_(std::move(plant)), free_(std::move(free)), stream_(stream), length_(length) {
  const auto unit = [&](const FreeParameter& f) { return parameter_record(plant_, f.id).unit; };
  for (const FreeParameter& f : free_) {
    if (is_time(parameter_record(plant_, f.id))) longest_ = std::max(longest_, parameter_value(plant_, f.id));
    const auto first = std::ranges::find(free_, unit(f), unit);
    unit_.push_back(static_cast<std::uint32_t>(first - free_.begin()));
  }
}

std::optional<std::vector<double>> Draws::operator()(std::uint64_t number) const {
  for (std::uint64_t attempt = 0; attempt < kRedraws; ++attempt)
    if (auto values = once(number, attempt); runs(values)) return values;
  return std::nullopt;
}

std::vector<double> Draws::once(std::uint64_t number, std::uint64_t attempt) const {
  const std::uint64_t sample = attempt << 32 | number;
  std::vector<double> values;
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const double value = parameter_value(plant_, free_[i].id);
    const auto range = sim::plant::search_range(parameter_record(plant_, free_[i].id), value);
    const double factor = number % 2 == 0 ? independent(i, sample) : ordered(i, sample);
    values.push_back(std::clamp(value * factor, range.low, range.high));
  }
  return values;
}

/// Returns the factor by which an even draw multiplies the plant's value.
double Draws::independent(std::size_t i, std::uint64_t sample) const {
  const auto [which, where] = sim::uniform_pair(stream_, stream(i, reduced), sample);
  if (which < kShareOfReduced) return std::pow(10.0, -kDecadesBelow * where);
  const double moved =
      kIndependentWidth * free_[i].prior_sd * sim::normal_pair(stream_, stream(i, own), sample)[0];
  return may_change_sign(parameter_record(plant_, free_[i].id)) ? 1 + moved : std::exp(moved);
}

/// Returns the factor by which an odd draw multiplies the plant's value.
double Draws::ordered(std::size_t i, std::uint64_t sample) const {
  const sim::Parameter& p = parameter_record(plant_, free_[i].id);
  const double width = (p.low > 0 && p.high / p.low >= 1000 ? kGainWidth : kOrderedWidth) * free_[i].prior_sd;
  const auto part = [&](std::uint32_t from) {
    return std::sqrt(0.5) * width * sim::normal_pair(stream_, from, sample)[0];
  };
  const double shared = part(stream(unit_[i], common)), alone = part(stream(i, own));
  if (may_change_sign(p)) return 1 + shared + alone;
  if (!is_time(p) || longest_ == 0 || length_ == 0) return std::exp(shared + alone);
  const double share = sim::uniform_pair(stream_, stream(0, whole), sample)[0];
  return std::pow(kShortestDraw, share) * length_ / longest_ * std::exp(alone);
}

bool Draws::runs(const std::vector<double>& values) const {
  const sim::plant::Plant plant = with_values(plant_, free_, values);
  return std::ranges::all_of(free_, [&](const FreeParameter& f) {
    return playin::can_run(sim::plant::block_at(plant, f.id.block));
  });
}

}  // namespace swingbank::validate::fit
