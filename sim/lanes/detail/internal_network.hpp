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
/// Where among the rows of InternalMatrix::far_g, far_b those of one plant's control stand
/// (Plant::far_place); -1: it measures that at its plant.
struct FarRows {
  int voltage = -1;             ///< of the bus that it regulates
  int near = -1, current = -1;  ///< of the branch whose flow counts: voltage and current at its near end
};
/// Per plant; `rows`: how many there are.
std::vector<FarRows> far_rows(const grid::Grid& grid, int& rows);

/// I = (G + jB) E, row and column per source: plants, then loads with a model of their own; currents on each
/// source's own base [pu]. Row-major.
struct InternalMatrix : Terminals {
  std::vector<double> g, b;
  /// What plants' controls measure elsewhere, likewise of E: voltages, and currents on the plant's own base
  /// [pu].
  std::vector<double> far_g, far_b;
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
  void assemble_far(Reduced& entry, const Eigen::MatrixXcd& voltage) const;
  int node_at(int bus);

  const grid::Grid& grid_;
  std::vector<int> buses_;      ///< buses with sources and those that a control measures at, one entry each
  std::vector<int> node_of_;    ///< per source: position in buses_
  std::vector<double> base_;    ///< per source: own base over the network's
  std::vector<int> generator_;  ///< per source: index into Network::generators, -1 for a load
  std::vector<FarRows> far_;    ///< per plant
  int far_count_ = 0;
  std::deque<Reduced> cache_;
};

}  // namespace swingbank::sim::lanes
