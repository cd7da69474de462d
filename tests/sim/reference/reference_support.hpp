#pragma once
// Grids and comparisons used by the tests of the reference integrator.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "sim/reference/reference.hpp"

namespace swingbank::sim::test {

/// "ieee39_genrou" -> configs/networks/ieee39_genrou.raw and .dyr
inline grid::Grid configured_grid(const std::string& name, Conventions conventions) {
  const std::filesystem::path folder = std::filesystem::path(SWINGBANK_SOURCE) / "configs/networks";
  return grid::load_grid(folder / (name + ".raw"), folder / (name + ".dyr"), conventions);
}

/// One GENROU behind two parallel lines against GENCLS with H = 0, with a load in between. Bus 1: infinite
/// bus, bus 2: load, bus 3: machine.
inline grid::Grid two_machine_grid(Conventions conventions, double resistance = 0.0) {
  network::Network net;
  net.title = "two machines";
  net.origin = "two machines";
  net.buses = {{1, "INFINITE", 138.0, network::BusType::slack, 1.02, 0.0},
               {2, "LOAD", 138.0, network::BusType::load, 1.0, 0.0},
               {3, "MACHINE", 138.0, network::BusType::generator, 1.01, 0.0}};
  network::Load load{};
  load.bus = 1;
  load.id = "1";
  load.power = {0.8, 0.2};
  net.loads = {load};
  const auto line = [](int from, int to, const char* circuit) {
    network::Branch b{};
    b.from = from;
    b.to = to;
    b.circuit = circuit;
    b.r = 0.01;
    b.x = 0.12;
    b.b = 0.02;
    b.in_service = true;
    b.tap = 1.0;
    return b;
  };
  net.branches = {line(0, 1, "1"), line(0, 1, "2"), line(1, 2, "1"), line(1, 2, "2")};
  const auto machine = [](int bus, double p, double vset, double mva, double zr, double zx) {
    network::Generator g{};
    g.bus = bus;
    g.id = "1";
    g.p = p;
    g.vset = vset;
    g.mva = mva;
    g.zr = zr;
    g.zx = zx;
    g.in_service = true;
    return g;
  };
  net.generators = {machine(0, 0.0, 1.02, 100.0, 0.0, 1e-4), machine(2, 0.9, 1.01, 150.0, resistance, 0.25)};
  const std::vector<formats::DyrRecord> dynamics = {
      {1, "GENCLS", "1", {0.0, 0.0}, 1},
      {3, "GENROU", "1", {8.0, 0.03, 0.4, 0.05, 6.175, 0.05, 1.8, 1.7, 0.3, 0.55, 0.25, 0.2, 0.1, 0.8}, 2}};
  return grid::make_grid(std::move(net), dynamics, "two machines", conventions);
}

/// Largest difference between two runs of the same shape, over all channels and samples.
inline double largest_difference(const Trajectory& a, const Trajectory& b) {
  EXPECT_EQ(a.rows(), b.rows());
  EXPECT_EQ(a.samples, b.samples);
  double worst = 0.0;
  for (int row = 0; row < std::min(a.rows(), b.rows()); ++row)
    for (int k = 0; k < std::min(a.samples, b.samples); ++k)
      worst = std::max(worst, std::abs(a.row(row)[k] - b.row(row)[k]));
  return worst;
}

/// A comma-separated table of numbers; names is empty if the file has no header.
struct Table {
  std::vector<std::string> names;
  std::vector<std::vector<double>> rows;
  [[nodiscard]] int column(const std::string& name) const {
    const auto at = std::find(names.begin(), names.end(), name);
    return at == names.end() ? -1 : static_cast<int>(at - names.begin());
  }
};
inline Table read_table(const std::filesystem::path& file, bool header) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot read " + file.string());
  Table table;
  std::string line, cell;
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    if (header && table.names.empty()) {
      while (std::getline(cells, cell, ',')) table.names.push_back(cell);
      continue;
    }
    auto& row = table.rows.emplace_back();
    while (std::getline(cells, cell, ',')) row.push_back(std::stod(cell));
  }
  return table;
}

}  // namespace swingbank::sim::test
