#pragma once
// Grids of any size: a ring of generator buses with chords, each machine behind its own transformer, a load
// at every ring bus.
#include "sim/grid/grid.hpp"

namespace swingbank::sim {

inline network::Branch branch(int from, int to, double x, bool transformer) {
  network::Branch b{};
  b.from = from;
  b.to = to;
  b.circuit = "1";
  b.r = transformer ? 0.0 : 0.1 * x;
  b.x = x;
  b.transformer = transformer;
  return b;
}

/// n machines of 100 MVA at 80 MW; bus 2i is the ring's, bus 2i + 1 the machine's.
inline grid::Grid synthetic(int n) {
  network::Network net;
  net.title = net.origin = "synthetic";
  std::vector<formats::DyrRecord> dynamics;
  for (int i = 0; i < n; ++i) {
    net.buses.push_back({2 * i + 1, "RING", 230.0, network::BusType::load, 1.0, 0.0});
    net.buses.push_back(
        {2 * i + 2, "UNIT", 20.0, i == 0 ? network::BusType::slack : network::BusType::generator, 1.02, 0.0});
    net.branches.push_back(branch(2 * i, 2 * i + 1, 0.1, true));
    net.branches.push_back(branch(2 * i, 2 * ((i + 1) % n), 0.05, false));
    if (i % 2 == 0 && n > 6) {
      net.branches.push_back(branch(2 * i, 2 * ((i + n / 3) % n), 0.1, false));
      net.branches.back().circuit = "2";
    }
    network::Load load{};
    load.bus = 2 * i;
    load.id = "1";
    load.power = {0.8, 0.2};
    net.loads.push_back(load);
    network::Generator g{};
    g.bus = 2 * i + 1;
    g.id = "1";
    g.p = 0.8;
    g.vset = 1.02;
    g.mva = 100.0;
    g.zx = 0.25;
    net.generators.push_back(g);
    dynamics.push_back(
        {2 * i + 2,
         "GENROU",
         "1",
         {8.0, 0.03, 0.4, 0.05, 4.0 + 0.1 * (i % 10), 1.0, 1.8, 1.7, 0.3, 0.55, 0.25, 0.2, 0.1, 0.4},
         i + 1});
  }
  return grid::make_grid(std::move(net), dynamics, "synthetic", Conventions::psse());
}

}  // namespace swingbank::sim
