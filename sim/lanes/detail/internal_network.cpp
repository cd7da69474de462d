#include "sim/lanes/detail/internal_network.hpp"

#include <algorithm>

namespace swingbank::sim::lanes {

namespace {
constexpr std::size_t kCacheLimit = 4096;  // topologies: one per bus and branch of any grid we run, and more
}

InternalNetwork::InternalNetwork(const grid::Grid& grid) : grid_(grid) {
  const auto add = [&](int bus, double mva, int generator) {
    auto at = std::find(buses_.begin(), buses_.end(), bus);
    node_of_.push_back(static_cast<int>(at - buses_.begin()));
    if (at == buses_.end()) buses_.push_back(bus);
    base_.push_back(mva / grid.network.base_mva);
    generator_.push_back(generator);
  };
  for (const plant::Plant& plant : grid.plants) add(plant.bus, plant.mva, plant.generator);
  for (const plant::Consumer& load : grid.loads) add(load.bus, load.mva, -1);
}

InternalNetwork::Reduced& InternalNetwork::reduced(const network::Topology& topology) {
  for (auto& entry : cache_)
    if (entry.topology == topology) return entry;
  if (cache_.size() >= kCacheLimit) cache_.pop_front();
  cache_.push_back({topology,
                    network::reduce(grid_.network, grid_.flow, topology, buses_, grid_.modelled_loads()),
                    {},
                    {},
                    {}});
  return cache_.back();
}

void InternalNetwork::assemble(Reduced& entry, const std::vector<double>& r,
                               const std::vector<double>& x) const {
  const auto plants = static_cast<Eigen::Index>(node_of_.size());
  const auto nodes = static_cast<Eigen::Index>(buses_.size());
  std::vector<char> node_grounded(buses_.size(), 0);
  for (int n : entry.network.grounded) node_grounded[static_cast<std::size_t>(n)] = 1;

  auto& out = entry.latest;
  out.tripped.assign(node_of_.size(), 0);
  out.connected.assign(node_of_.size(), 1.0);
  Eigen::VectorXcd source(plants);  // admittance of each on the network's base
  for (Eigen::Index i = 0; i < plants; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (generator_[k] >= 0) out.connected[k] = entry.topology.connected(generator_[k]);
    out.tripped[k] = out.connected[k] == 0.0;
    source[i] = out.connected[k] * base_[k] / Complex(r[k], x[k]);
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
  out.g.resize(static_cast<std::size_t>(plants * plants));
  out.b.resize(out.g.size());
  out.grounded.resize(static_cast<std::size_t>(plants));
  for (Eigen::Index i = 0; i < plants; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double to_own = out.tripped[k] ? 0.0 : 1.0 / (out.connected[k] * base_[k]);
    out.grounded[k] = node_grounded[static_cast<std::size_t>(node_of_[k])];
    for (Eigen::Index j = 0; j < plants; ++j) {
      const Complex drop = (i == j ? 1.0 : 0.0) - voltage(node_of_[k], j);
      const Complex m = source[i] * drop * to_own;
      out.g[static_cast<std::size_t>(i * plants + j)] = m.real();
      out.b[static_cast<std::size_t>(i * plants + j)] = m.imag();
    }
  }
  entry.r = r;
  entry.x = x;
}

const InternalMatrix& InternalNetwork::matrix(const network::Topology& topology, const std::vector<double>& r,
                                              const std::vector<double>& x) {
  Reduced& entry = reduced(topology);
  if (entry.r != r || entry.x != x) assemble(entry, r, x);
  return entry.latest;
}

}  // namespace swingbank::sim::lanes
