#pragma once
// Records of all machines of a grid in one fault, at the datasets' rate and precision.
#include <vector>

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

}  // namespace swingbank::sim::direct
