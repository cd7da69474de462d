#pragma once
// The network as the machines see it: currents at the terminals as a linear function of the voltages behind
// the machines' own impedances, per topology. Two steps: Kron reduction to the generator buses (once per
// topology), then a solve of the size of the generator buses with the machines' impedances (once per set of
// impedances).
#include <Eigen/Dense>
#include <deque>
#include <vector>

#include "sim/network/admittance.hpp"
#include "sim/solve/grid.hpp"

namespace swingbank::sim {

/// I = (G + jB) E, row and column per plant; currents on each machine's own base [pu]. Row-major.
struct InternalMatrix {
  std::vector<double> g, b;
  std::vector<char> grounded;  ///< per plant: 1 where the terminal is held at V = 0
};

class InternalNetwork {
 public:
  explicit InternalNetwork(const Grid& grid);
  /// r, x: source impedance per plant [pu on its own base]. The reference stays valid until the next call
  /// with other impedances; for unchanged impedances matrices are kept per topology.
  const InternalMatrix& matrix(const Topology& topology, const std::vector<double>& r,
                               const std::vector<double>& x);

 private:
  struct Reduced {
    Topology topology;
    ReducedNetwork network;
    InternalMatrix latest;
    std::vector<double> r, x;  ///< impedances `latest` was made with
  };
  Reduced& reduced(const Topology& topology);
  void assemble(Reduced& entry, const std::vector<double>& r, const std::vector<double>& x) const;

  const Grid& grid_;
  std::vector<int> buses_;    ///< generator buses, one entry each
  std::vector<int> node_of_;  ///< per plant: position in buses_
  std::deque<Reduced> cache_;
};

}  // namespace swingbank::sim
