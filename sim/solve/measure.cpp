#include "sim/solve/measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/core/noise.hpp"
#include "sim/core/window.hpp"
#include "sim/solve/block_text.hpp"

namespace swingbank::sim {
namespace {

constexpr double kTurn = 6.28318530717958647692;

int channel_index(const Trajectory& run, Channel channel) {
  const auto at = std::ranges::find(run.channels, channel);
  if (at == run.channels.end())
    throw InputError(
        {"channel " + std::string(kChannels[static_cast<std::size_t>(channel)].name) + " missing", "the run",
         "an instrument sees V, theta, P and Q", "record all four"});
  return static_cast<int>(at - run.channels.begin());
}

}  // namespace

Phasors phasors_of(const TerminalRecord& record, double rate, double frequency, const std::string& where) {
  Phasors phasors{rate, frequency, {}, {}, record.df};
  if (phasors.df.empty()) phasors.df = frequency_deviation(record.theta, rate, frequency);
  for (std::size_t k = 0; k < record.V.size(); ++k) {
    if (record.V[k] == 0.0)
      throw InputError({fmt::format("V = 0 pu after {:g} s", static_cast<double>(k) / rate), where,
                        "P and Q do not tell the current there, so no instrument can be put on it",
                        "let the fault have an impedance, or measure another plant"});
    const Complex v = std::polar(record.V[k], record.theta[k]);
    phasors.V.push_back(v);
    phasors.I.push_back(std::conj(Complex(record.P[k], record.Q[k]) / v));
  }
  return phasors;
}

TerminalRecord terminal_of(const Phasors& phasors, double first_theta) {
  TerminalRecord record;
  record.df = phasors.df;
  double last = first_theta;
  for (std::size_t k = 0; k < phasors.V.size(); ++k) {
    const Complex v = phasors.V[k], power = v * std::conj(phasors.I[k]);
    const double angle = std::arg(v), theta = angle + kTurn * std::nearbyint((last - angle) / kTurn);
    if (std::isfinite(theta)) last = theta;
    record.V.push_back(std::abs(v));
    record.theta.push_back(theta);
    record.P.push_back(power.real());
    record.Q.push_back(power.imag());
  }
  return record;
}

void measure(std::span<const Block> chain, std::uint64_t seed, Phasors& phasors) {
  for (std::size_t k = 0; k < chain.size(); ++k)
    chain[k].effect->measure(chain[k].p.data(), seed_of(seed, k), phasors);
}

double memory(std::span<const Block> chain) {
  double sum = 0.0;
  for (const Block& block : chain)
    if (block.effect->memory) sum += block.effect->memory(block.p.data());
  return sum;
}

std::optional<Block> read_measurement(const std::string& text, const std::string& where, Problems& problems) {
  const auto colon = text.find(':');
  const Effect* effect = find_effect(text.substr(0, colon));
  if (!effect || effect->slot != Slot::measurement) {
    problems.add("no measurement effect '" + text.substr(0, colon) + "'", where,
                 "there are " + effect_names(Slot::measurement),
                 "write EFFECT[:PARAM=VALUE,...] with one of these");
    return {};
  }
  Block block{effect, effect->standard_parameters()};
  Problems found;
  if (colon != text.npos) set_parameters(block, text.substr(colon + 1), where, found);
  if (found.empty()) effect->check(effect->law.get(), block.p.data(), where, found);
  problems.add(found);
  if (!found.empty()) return {};
  return block;
}

std::vector<std::vector<double>> measure_run(const Grid& grid, std::span<const Block> chain,
                                             std::uint64_t seed, Trajectory& run) {
  const int v = channel_index(run, Channel::V), theta = channel_index(run, Channel::theta),
            p = channel_index(run, Channel::P), q = channel_index(run, Channel::Q);
  std::vector<std::vector<double>> frequency;
  for (std::size_t i = 0; i < run.plants.size(); ++i) {
    const Plant& plant = grid.plants[static_cast<std::size_t>(run.plants[i])];
    const auto row = [&](int channel) { return run.at(static_cast<int>(i), channel); };
    const auto column = [&](int channel) {
      return std::vector<double>(row(channel), row(channel) + run.samples);
    };
    const TerminalRecord before{column(v), column(theta), column(p), column(q), {}};
    Phasors phasors = phasors_of(before, run.rate, grid.conventions.frequency, "plant " + plant.name);
    std::vector<Block> whole = plant.measurements;
    whole.insert(whole.end(), chain.begin(), chain.end());
    measure(whole, seed_of(seed, static_cast<std::uint64_t>(run.plants[i])), phasors);
    const TerminalRecord after = terminal_of(phasors, before.theta.front());
    std::ranges::copy(after.V, row(v));
    std::ranges::copy(after.theta, row(theta));
    std::ranges::copy(after.P, row(p));
    std::ranges::copy(after.Q, row(q));
    frequency.push_back(after.df);
    for (double& f : frequency.back()) f = grid.conventions.frequency * (1.0 + f);
  }
  return frequency;
}

}  // namespace swingbank::sim
