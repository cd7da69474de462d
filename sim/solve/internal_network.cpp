#include "sim/solve/internal_network.hpp"

#include <algorithm>

namespace swingbank::sim {

namespace {
constexpr std::size_t kCacheLimit = 4096;  // topologies: one per bus and branch of any grid we run, and more
}

InternalNetwork::InternalNetwork(const Grid& grid) : grid_(grid) {
  for (const auto& plant : grid.plants) {
    auto at = std::find(buses_.begin(), buses_.end(), plant.bus);
    node_of_.push_back(static_cast<int>(at - buses_.begin()));
    if (at == buses_.end()) buses_.push_back(plant.bus);
  }
}

InternalNetwork::Reduced& InternalNetwork::reduced(const Topology& topology) {
  for (auto& entry : cache_)
    if (entry.topology == topology) return entry;
  if (cache_.size() >= kCacheLimit) cache_.pop_front();
  cache_.push_back({topology, reduce(grid_.network, grid_.flow, topology, buses_), {}, {}, {}});
  return cache_.back();
}

void InternalNetwork::assemble(Reduced& entry, const std::vector<double>& r,
                               const std::vector<double>& x) const {
  const auto plants = static_cast<Eigen::Index>(grid_.plants.size());
  const auto nodes = static_cast<Eigen::Index>(buses_.size());
  std::vector<char> node_grounded(buses_.size(), 0);
  for (int n : entry.network.grounded) node_grounded[static_cast<std::size_t>(n)] = 1;

  Eigen::VectorXcd source(plants);  // admittance of each machine on the network's base
  for (Eigen::Index i = 0; i < plants; ++i) {
    const auto k = static_cast<std::size_t>(i);
    source[i] = grid_.plants[k].mva / grid_.network.base_mva / Complex(r[k], x[k]);
  }
  Eigen::MatrixXcd a = entry.network.y;
  Eigen::MatrixXcd injection = Eigen::MatrixXcd::Zero(nodes, plants);
  for (Eigen::Index i = 0; i < plants; ++i) {
    const Eigen::Index n = node_of_[static_cast<std::size_t>(i)];
    if (node_grounded[static_cast<std::size_t>(n)]) continue;
    a(n, n) += source[i];
    injection(n, i) = source[i];
  }
  for (Eigen::Index n = 0; n < nodes; ++n)
    if (node_grounded[static_cast<std::size_t>(n)]) {
      a.row(n).setZero();
      a(n, n) = 1.0;
    }
  const Eigen::MatrixXcd voltage =
      a.partialPivLu().solve(injection);  // V at the generator buses per unit of E
  auto& out = entry.latest;
  out.g.resize(static_cast<std::size_t>(plants * plants));
  out.b.resize(out.g.size());
  out.grounded.resize(static_cast<std::size_t>(plants));
  for (Eigen::Index i = 0; i < plants; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double to_machine = grid_.network.base_mva / grid_.plants[k].mva;
    out.grounded[k] = node_grounded[static_cast<std::size_t>(node_of_[k])];
    for (Eigen::Index j = 0; j < plants; ++j) {
      const Complex drop = (i == j ? 1.0 : 0.0) - voltage(node_of_[k], j);
      const Complex m = source[i] * drop * to_machine;
      out.g[static_cast<std::size_t>(i * plants + j)] = m.real();
      out.b[static_cast<std::size_t>(i * plants + j)] = m.imag();
    }
  }
  entry.r = r;
  entry.x = x;
}

const InternalMatrix& InternalNetwork::matrix(const Topology& topology, const std::vector<double>& r,
                                              const std::vector<double>& x) {
  Reduced& entry = reduced(topology);
  if (entry.r != r || entry.x != x) assemble(entry, r, x);
  return entry.latest;
}

}  // namespace swingbank::sim
