#pragma once
// The network reduced to the sources' internal nodes: terminal currents as a linear function of the voltages
// behind the machines' impedances, per topology. The reduction has two steps: Kron reduction to the buses
// with sources and the remotely measured buses, once per topology, then a dense solve with the sources'
// impedances, once per set of impedances.
#include <Eigen/Dense>
#include <deque>
#include <vector>

#include "sim/grid/grid.hpp"
#include "sim/network/admittance.hpp"

namespace swingbank::sim::batch {

/// Connection status of each source.
struct Terminals {
  std::vector<char> grounded;     ///< 1 if V = 0 at the bus (bolted fault, or no generator in its island)
  std::vector<char> tripped;      ///< 1 if the source is disconnected
  std::vector<double> connected;  ///< connected fraction of its units, 0 to 1
};
/// Row indices in InternalMatrix::far_g and far_b of one plant's remote measurements (Plant::far_place);
/// -1: the control measures at its plant.
struct FarRows {
  int voltage = -1;             ///< row of the regulated bus
  int near = -1, current = -1;  ///< rows of the measured branch: voltage and current at its near end
};
/// Returns the row indices per plant, and sets `rows` to the number of rows.
std::vector<FarRows> far_rows(const grid::Grid& grid, int& rows);

/// Matrix of I = (G + jB) E, row-major, with a row and a column per source: plants, then loads with a dynamic
/// model. Currents are on each source's own base [pu].
struct InternalMatrix : Terminals {
  std::vector<double> g, b;
  /// Remote measurements as linear functions of E: voltages, and currents on the plant's own base [pu].
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

/// Computes and caches the internal matrices of a grid per topology.
class InternalNetwork {
 public:
  explicit InternalNetwork(const grid::Grid& grid);
  [[nodiscard]] int sources() const { return static_cast<int>(node_of_.size()); }
  /// Returns the matrix of a topology. r, x: impedance per source [pu on its own base]. The matrix of each
  /// topology is cached until r or x changes. The reference is valid until the next call for this topology
  /// with other impedances, or until calls for many other topologies remove it from the cache (kCacheLimit).
  const InternalMatrix& matrix(const network::Topology& topology, const std::vector<double>& r,
                               const std::vector<double>& x);

 private:
  struct Reduced {
    network::Topology topology;
    network::ReducedNetwork network;
    InternalMatrix latest;
    std::vector<double> r, x;  ///< impedances of `latest`
  };
  Reduced& reduced(const network::Topology& topology);
  void assemble(Reduced& entry, const std::vector<double>& r, const std::vector<double>& x) const;
  void assemble_far(Reduced& entry, const Eigen::MatrixXcd& voltage) const;
  int node_at(int bus);

  const grid::Grid& grid_;
  std::vector<int> buses_;      ///< buses with sources and remotely measured buses, one entry each
  std::vector<int> node_of_;    ///< per source: position in buses_
  std::vector<double> base_;    ///< per source: its base divided by the network's base
  std::vector<int> generator_;  ///< per source: index into Network::generators, -1 for a load
  std::vector<FarRows> far_;    ///< row indices per plant
  int far_count_ = 0;
  std::deque<Reduced> cache_;
};

}  // namespace swingbank::sim::batch
