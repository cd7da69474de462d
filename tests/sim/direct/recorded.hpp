#pragma once
// Records of all machines of a grid in one fault, at the datasets' rate and precision.
#include <vector>

#include "sim/core/noise.hpp"
#include "sim/core/recording.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::direct {

/// Record of one machine as in a dataset: 120 samples/s, single precision.
inline std::vector<Recording> recorded(const grid::Grid& grid, int bus, double cleared) {
  network::Event event;
  event.faults.push_back({grid.network.bus_index(bus), 2.0, cleared, {}});
  reference::ReferenceOptions options;
  options.rate = 120;
  options.t_end = 15;
  options.channels = {Channel::V, Channel::theta, Channel::P, Channel::Q, Channel::speed, Channel::Ifd};
  const auto run = reference::run_reference(grid, event, options);
  std::vector<Recording> all;
  for (int plant = 0; plant < static_cast<int>(grid.plants.size()); ++plant) {
    Recording r;
    r.step = 1 / options.rate;
    r.conventions = grid.conventions;
    std::vector<double>* channels[] = {&r.V, &r.theta, &r.P, &r.Q, &r.speed, &r.Ifd};
    for (int c = 0; c < 6; ++c)
      for (int k = 0; k < run.samples; ++k) channels[c]->push_back(static_cast<float>(run.at(plant, c)[k]));
    all.push_back(std::move(r));
  }
  return all;
}

/// Adds noise of a level to all channels.
inline Recording with_noise(Recording r, double level, std::uint64_t seed) {
  r.noise = {level};
  const auto add = [&](std::vector<double>& x, std::uint32_t key, double deviation, bool of_value) {
    for (std::size_t k = 0; k < x.size(); ++k)
      x[k] += deviation * (of_value ? x[k] : 1.0) * normal_pair(seed, key, k)[0];
  };
  add(r.V, 0, r.noise.phasor(), false);
  add(r.theta, 1, r.noise.phasor(), false);
  add(r.P, 2, r.noise.phasor(), false);
  add(r.Q, 3, r.noise.phasor(), false);
  add(r.speed, 4, r.noise.speed(), false);
  add(r.Ifd, 5, level, true);
  return r;
}

}  // namespace swingbank::sim::direct
