#pragma once
// A grid of any size: copies of the 39-bus network, arranged on a torus. Each copy has 50 buses, because
// eleven lines are cut in the middle, and 10 machines. Three tie lines lead to the next copy, and three to
// the copy one row further.
#include <algorithm>
#include <cmath>

#include "sim/grid/grid.hpp"
#include "sim/library/library.hpp"

namespace swingbank::sim {

namespace tiled_detail {
constexpr int kCuts = 11, kNumbers = 100;  ///< number of lines cut; range of bus numbers of a copy

/// The network with the first lines cut in two halves.
inline network::Network cut_lines(network::Network net) {
  int cuts = 0;
  for (std::size_t i = 0; cuts < kCuts; ++i) {
    network::Branch& line = net.branches.at(i);
    if (line.transformer) continue;
    const int middle = static_cast<int>(net.buses.size());
    network::Bus bus = net.buses[static_cast<std::size_t>(line.from)];
    bus.number = 40 + cuts++;
    bus.name = "MIDDLE";
    bus.type = network::BusType::load;
    net.buses.push_back(bus);
    line.r /= 2;
    line.x /= 2;
    line.b /= 2;
    network::Branch other = line;
    other.from = middle;
    line.to = middle;
    net.branches.push_back(other);
  }
  return net;
}

inline network::Branch tie(int from, int to, const std::string& circuit) {
  network::Branch b{};
  b.from = from;
  b.to = to;
  b.circuit = circuit;
  b.r = 0.002;
  b.x = 0.03;
  b.b = 0.2;
  return b;
}
}  // namespace tiled_detail

/// `raw`: the 39-bus network. Loads of the copies are up to 3 % smaller than in `raw`, and power flows
/// between the copies. Each copy keeps its swing bus, so that no single machine balances all copies.
inline network::Network tiled_network(const std::filesystem::path& raw, int tiles) {
  const network::Network one = tiled_detail::cut_lines(formats::read_raw(raw));
  const auto buses = static_cast<int>(one.buses.size());
  network::Network net;
  net.base_mva = one.base_mva;
  net.frequency = one.frequency;
  net.title = std::to_string(tiles) + " copies of " + one.title;
  for (int t = 0; t < tiles; ++t) {
    const int first = t * buses;
    const double share = 0.985 + 0.015 * std::sin(2.0 * t);
    for (network::Bus bus : one.buses) {
      bus.number += t * tiled_detail::kNumbers;
      net.buses.push_back(bus);
    }
    for (network::Load load : one.loads) {
      load.bus += first;
      load.power *= share;
      net.loads.push_back(load);
    }
    for (network::Shunt shunt : one.shunts) {
      shunt.bus += first;
      net.shunts.push_back(shunt);
    }
    for (network::Branch branch : one.branches) {
      branch.from += first;
      branch.to += first;
      net.branches.push_back(branch);
    }
    for (network::Generator machine : one.generators) {
      machine.bus += first;
      if (machine.regulated >= 0) machine.regulated += first;
      net.generators.push_back(machine);
    }
  }
  const int row = std::max(1, static_cast<int>(std::sqrt(tiles)));
  const auto join = [&](int from, int to, int way) {
    for (const int number : {3, 16, 26}) {
      const int bus = number - 1;  // the 39-bus file is in order
      if (from != to)
        net.branches.push_back(tiled_detail::tie(from * buses + bus, to * buses + bus, std::to_string(way)));
    }
  };
  for (int t = 0; t < tiles; ++t) {
    join(t, (t + 1) % tiles, 1);
    if (row > 1) join(t, (t + row) % tiles, 2);
  }
  return net;
}

/// Returns the .dyr records of all copies from those of one; `controls`: adds TGOV1, IEEEST and SEXS at their
/// defaults to every machine.
inline std::vector<formats::DyrRecord> tiled_dynamics(const std::filesystem::path& dyr, int tiles,
                                                      bool controls) {
  std::vector<formats::DyrRecord> one = formats::read_dyr(dyr), all;
  if (controls)
    for (std::size_t i = 0, machines = one.size(); i < machines; ++i)
      for (const char* name : {"TGOV1", "IEEEST", "SEXS"}) {
        const Effect& effect = *library::compiled().find(name);
        const auto standard = effect.default_parameters();
        formats::DyrRecord record = one[i];
        record.model = name;
        record.values.clear();
        for (const int column : effect.dyr_columns)
          record.values.push_back(standard[static_cast<std::size_t>(column)]);
        one.push_back(record);
      }
  for (int t = 0; t < tiles; ++t)
    for (formats::DyrRecord record : one) {
      record.bus += t * tiled_detail::kNumbers;
      record.line = static_cast<int>(all.size()) + 1;
      all.push_back(record);
    }
  return all;
}

}  // namespace swingbank::sim
