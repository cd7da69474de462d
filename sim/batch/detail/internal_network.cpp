#include "sim/batch/detail/internal_network.hpp"

#include <algorithm>

namespace swingbank::sim::batch {

namespace {
constexpr std::size_t kCacheLimit = 4096;  // topologies; more than the buses and branches of usual grids
}

std::vector<FarRows> far_rows(const grid::Grid& grid, int& rows) {
  std::vector<FarRows> all(grid.plants.size());
  rows = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const plant::FarPlace& place = grid.plants[i].far_place;
    if (place.bus >= 0) all[i].voltage = rows++;
    if (place.branch < 0) continue;
    all[i].near = rows++;
    all[i].current = rows++;
  }
  return all;
}

/// Returns the index of a bus in buses_, and appends the bus if it is missing.
int InternalNetwork::node_at(int bus) {
  const auto at = std::ranges::find(buses_, bus);
  const auto node = static_cast<int>(at - buses_.begin());
  if (at == buses_.end()) buses_.push_back(bus);
  return node;
}

InternalNetwork::InternalNetwork(const grid::Grid& grid) : grid_(grid) {
  const auto add = [&](int bus, double mva, int generator) {
    node_of_.push_back(node_at(bus));
    base_.push_back(mva / grid.network.base_mva);
    generator_.push_back(generator);
  };
  for (const plant::Plant& plant : grid.plants) add(plant.bus, plant.mva, plant.generator);
  for (const plant::Consumer& load : grid.loads) add(load.bus, load.mva, -1);
  far_ = far_rows(grid, far_count_);
  for (const plant::Plant& plant : grid.plants) {
    if (plant.far_place.bus >= 0) node_at(plant.far_place.bus);
    if (plant.far_place.branch < 0) continue;
    const network::Branch& b = grid.network.branches[static_cast<std::size_t>(plant.far_place.branch)];
    node_at(b.from);
    node_at(b.to);
  }
}

/// Computes the rows of remote measurements. `voltage`: node voltages per unit of E.
void InternalNetwork::assemble_far(Reduced& entry, const Eigen::MatrixXcd& voltage) const {
  const auto sources = static_cast<std::size_t>(voltage.cols());
  InternalMatrix& out = entry.latest;
  out.far_g.assign(static_cast<std::size_t>(far_count_) * sources, 0.0);
  out.far_b = out.far_g;
  const auto at = [&](int bus) -> Eigen::RowVectorXcd {
    return voltage.row(std::ranges::find(buses_, bus) - buses_.begin());
  };
  const auto put = [&](int row, const Eigen::RowVectorXcd& values) {
    for (std::size_t j = 0; j < sources; ++j) {
      const std::size_t to = static_cast<std::size_t>(row) * sources + j;
      out.far_g[to] = values[static_cast<Eigen::Index>(j)].real();
      out.far_b[to] = values[static_cast<Eigen::Index>(j)].imag();
    }
  };
  for (std::size_t i = 0; i < far_.size(); ++i) {
    const auto& [bus, branch, at_from] = grid_.plants[i].far_place;
    if (bus >= 0) put(far_[i].voltage, at(bus));
    if (branch < 0) continue;
    const network::Branch& b = grid_.network.branches[static_cast<std::size_t>(branch)];
    const Eigen::RowVectorXcd near = at(at_from ? b.from : b.to), other = at(at_from ? b.to : b.from);
    put(far_[i].near, near);
    if (std::ranges::binary_search(entry.topology.open, branch))
      continue;  // an open branch carries no current
    const network::BranchEnd end = network::branch_end(b, at_from);
    put(far_[i].current, (end.own * near + end.other * other) / base_[i]);
  }
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
  Eigen::VectorXcd source(plants);  // admittances of the sources on the network's base
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
      a.partialPivLu().solve(injection);  // V at the buses in buses_ per unit of E
  out.g.resize(static_cast<std::size_t>(plants * plants));
  out.b.resize(out.g.size());
  out.grounded.resize(static_cast<std::size_t>(plants));
  if (far_count_ > 0) assemble_far(entry, voltage);
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

}  // namespace swingbank::sim::batch
