#pragma once
// The network as the machines see it: currents at the terminals as a linear function of the voltages behind
// the machines' own impedances, per topology. Two steps: Kron reduction to the buses with sources (once per
// topology), then a solve of their number with the sources' impedances (once per set of impedances).
#include <Eigen/Dense>
#include <deque>
#include <vector>

#include "sim/grid/grid.hpp"
#include "sim/network/admittance.hpp"

namespace swingbank::sim::lanes {

/// How each source is connected.
struct Terminals {
  std::vector<char> grounded;     ///< 1 where the bus is held at V = 0
  std::vector<char> tripped;      ///< 1 where it is disconnected
  std::vector<double> connected;  ///< part of its units that is connected
};
/// I = (G + jB) E, row and column per source: plants, then loads with a model of their own; currents on each
/// source's own base [pu]. Row-major.
struct InternalMatrix : Terminals {
  std::vector<double> g, b;
  [[nodiscard]] Eigen::VectorXcd row(int k) const {
    const auto n = static_cast<Eigen::Index>(grounded.size());
    Eigen::VectorXcd v(n);
    for (Eigen::Index j = 0; j < n; ++j) v[j] = entry(k * n + j);
    return v;
  }
  [[nodiscard]] Eigen::VectorXcd column(int k) const {
    const auto n = static_cast<Eigen::Index>(grounded.size());
    Eigen::VectorXcd v(n);
    for (Eigen::Index i = 0; i < n; ++i) v[i] = entry(i * n + k);
    return v;
  }

 private:
  [[nodiscard]] Complex entry(Eigen::Index at) const {
    return {g[static_cast<std::size_t>(at)], b[static_cast<std::size_t>(at)]};
  }
};

class InternalNetwork {
 public:
  explicit InternalNetwork(const grid::Grid& grid);
  [[nodiscard]] int sources() const { return static_cast<int>(node_of_.size()); }
  /// r, x: impedance per source [pu on its own base]. The reference stays valid until the next call
  /// with other impedances; for unchanged impedances matrices are kept per topology.
  const InternalMatrix& matrix(const network::Topology& topology, const std::vector<double>& r,
                               const std::vector<double>& x);

 private:
  struct Reduced {
    network::Topology topology;
    network::ReducedNetwork network;
    InternalMatrix latest;
    std::vector<double> r, x;  ///< impedances `latest` was made with
  };
  Reduced& reduced(const network::Topology& topology);
  void assemble(Reduced& entry, const std::vector<double>& r, const std::vector<double>& x) const;

  const grid::Grid& grid_;
  std::vector<int> buses_;      ///< buses with sources, one entry each
  std::vector<int> node_of_;    ///< per source: position in buses_
  std::vector<double> base_;    ///< per source: own base over the network's
  std::vector<int> generator_;  ///< per source: index into Network::generators, -1 for a load
  std::deque<Reduced> cache_;
};

}  // namespace swingbank::sim::lanes
