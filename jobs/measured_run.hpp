#pragma once
// Simulated instruments (transducers, PMUs) that measure a run before `simulate` writes it.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "sim/grid/measure_run.hpp"
#include "sim/reference/reference.hpp"

namespace swingbank::sim {

/// Simulated run in the form that `simulate` writes. `frequency` is empty if no instrument measured the run.
struct MeasuredRun : reference::ReferenceRun {
  std::vector<std::vector<double>> frequency;  ///< [plant][sample], reported by the instruments [Hz]
};

/// Returns every `factor`-th sample of some channels of a run.
inline MeasuredRun thinned(const MeasuredRun& run, int factor, const std::vector<Channel>& channels) {
  MeasuredRun thin = run;
  thin.rate = run.rate / factor;
  thin.samples = (run.samples - 1) / factor + 1;
  thin.channels = channels;
  thin.allocate(false);
  const auto take = [&](const double* from, double* to) {
    for (int k = 0; k < thin.samples; ++k) to[k] = from[static_cast<std::ptrdiff_t>(k) * factor];
  };
  const auto old = [&](Channel c) {
    return static_cast<int>(std::ranges::find(run.channels, c) - run.channels.begin());
  };
  for (int p = 0; p < static_cast<int>(run.plants.size()); ++p)
    for (int c = 0; c < static_cast<int>(channels.size()); ++c)
      take(run.at(p, old(channels[static_cast<std::size_t>(c)])), thin.at(p, c));
  const auto take_all = [&](const std::vector<double>& from, std::vector<double>& to, std::size_t rows) {
    to.assign(rows * static_cast<std::size_t>(thin.samples), 0.0);
    for (std::size_t i = 0; i < rows; ++i) take(&from[i * run.samples], &to[i * thin.samples]);
  };
  take_all(run.bus_v, thin.bus_v, run.buses.size());
  take_all(run.bus_theta, thin.bus_theta, run.buses.size());
  for (std::size_t p = 0; p < run.frequency.size(); ++p) {
    thin.frequency[p].resize(static_cast<std::size_t>(thin.samples));
    take(run.frequency[p].data(), thin.frequency[p].data());
  }
  return thin;
}

/// Instruments of a run: first those of each plant, then those of --measure, which apply to all plants.
class Instruments {
 public:
  Instruments(const std::vector<std::string>& texts, const library::EffectLibrary& library,
              std::uint64_t seed, Problems& problems)
      : seed_(seed) {
    for (const auto& text : texts)
      if (auto block = plant::read_measurement(text, library, "--measure " + text, problems))
        chain_.push_back(std::move(*block));
  }

  /// Simulates with `play(rate factor, channels)`, which returns a ReferenceRun, measures the run, and
  /// returns the requested channels. If an instrument has memory (a window or filter), the run is simulated
  /// and measured at `kFiner` times the rate, so that its windows are resolved.
  template <class Play>
  MeasuredRun run(const grid::Grid& grid, const std::vector<int>& plants,
                  const std::vector<Channel>& channels, const Play& play) const {
    double reach = plant::memory(chain_);
    bool any = !chain_.empty();
    for (int p : plants) {
      const auto& own = grid.plants[static_cast<std::size_t>(p)].measurements;
      any = any || !own.empty();
      reach = std::max(reach, plant::memory(own) + plant::memory(chain_));
    }
    if (!any) return {play(1, channels), {}};
    constexpr int kFiner = 8;
    const int factor = reach > 0 ? kFiner : 1;
    std::vector<Channel> all = channels;
    for (Channel c : {Channel::V, Channel::theta, Channel::P, Channel::Q})
      if (std::ranges::find(all, c) == all.end()) all.push_back(c);
    MeasuredRun run{play(factor, all), {}};
    run.frequency = grid::measure_run(grid, chain_, seed_, run);
    return thinned(run, factor, channels);
  }

 private:
  std::vector<plant::Block> chain_;
  std::uint64_t seed_;
};

}  // namespace swingbank::sim
