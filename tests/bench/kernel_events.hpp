#pragma once
// Events and grids of the kernel's benchmarks.
#include <random>

#include "sim/batch/batch.hpp"
#include "sim/library/library.hpp"

namespace swingbank::sim {

/// Random bolted faults of 0.05-0.2 s at any bus; one random machine with parameters within 10 % of the
/// file's.
inline std::vector<batch::Job> jobs(const grid::Grid& grid, int count) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  std::vector<batch::Job> list(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < list.size(); ++i) {
    auto& job = list[i];
    job.id = i;
    const int bus = static_cast<int>(u(random) * static_cast<double>(grid.network.buses.size()));
    job.event.faults.push_back({bus, 2.0, 2.0 + 0.05 + 0.15 * u(random), {}});
    const auto plant = static_cast<std::size_t>(u(random) * static_cast<double>(grid.plants.size()));
    auto p = grid.plants[plant].machine.p;
    for (auto& v : p) v *= 0.9 + 0.2 * u(random);
    if (grid.plants[plant].machine.effect->unphysical(p.data()).empty())
      job.parameters.push_back({static_cast<int>(plant), sim::plant::kMachineBlock, p});
  }
  return list;
}

/// The same grid with an exciter, a governor and a stabiliser at their defaults on every machine.
inline grid::Grid controlled(grid::Grid grid) {
  for (plant::Plant& plant : grid.plants)
    for (const char* name : {"TGOV1", "IEEEST", "SEXS"}) {
      const Effect& e = *library::compiled().find(name);
      plant.controls.push_back({&e, e.default_parameters()});
    }
  return grid;
}

}  // namespace swingbank::sim
