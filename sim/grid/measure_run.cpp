#include "sim/grid/measure_run.hpp"

#include <algorithm>
#include <string>

#include "sim/core/noise.hpp"

namespace swingbank::sim::grid {
namespace {

int channel_index(const Trajectory& run, Channel channel) {
  const auto at = std::ranges::find(run.channels, channel);
  if (at == run.channels.end())
    throw InputError(
        {"channel " + std::string(kChannels[static_cast<std::size_t>(channel)].name) + " missing", "the run",
         "an instrument measures V, theta, P and Q", "record all four"});
  return static_cast<int>(at - run.channels.begin());
}

}  // namespace

std::vector<std::vector<double>> measure_run(const Grid& grid, std::span<const plant::Block> chain,
                                             std::uint64_t seed, Trajectory& run) {
  const int v = channel_index(run, Channel::V), theta = channel_index(run, Channel::theta),
            p = channel_index(run, Channel::P), q = channel_index(run, Channel::Q);
  std::vector<std::vector<double>> frequency;
  for (std::size_t i = 0; i < run.plants.size(); ++i) {
    const plant::Plant& plant = grid.plants[static_cast<std::size_t>(run.plants[i])];
    const auto row = [&](int channel) { return run.at(static_cast<int>(i), channel); };
    const auto column = [&](int channel) {
      return std::vector<double>(row(channel), row(channel) + run.samples);
    };
    const plant::TerminalRecord before{column(v), column(theta), column(p), column(q), {}};
    Phasors phasors = plant::phasors_of(before, run.rate, grid.conventions.frequency, "plant " + plant.name);
    std::vector<plant::Block> whole = plant.measurements;
    whole.insert(whole.end(), chain.begin(), chain.end());
    plant::measure(whole, seed_of(seed, static_cast<std::uint64_t>(run.plants[i])), phasors);
    const plant::TerminalRecord after = plant::terminal_of(phasors, before.theta.front());
    std::ranges::copy(after.V, row(v));
    std::ranges::copy(after.theta, row(theta));
    std::ranges::copy(after.P, row(p));
    std::ranges::copy(after.Q, row(q));
    frequency.push_back(after.df);
    for (double& f : frequency.back()) f = grid.conventions.frequency * (1.0 + f);
  }
  return frequency;
}

}  // namespace swingbank::sim::grid
