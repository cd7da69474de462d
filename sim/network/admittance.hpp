#pragma once
// Admittance matrices: the bus matrix with constant-impedance loads, faults and open branches in it, and its
// reduction to the generator buses.
#include <Eigen/Dense>
#include <Eigen/Sparse>

#include "sim/network/event.hpp"
#include "sim/network/powerflow.hpp"

namespace swingbank::sim::network {

/// Current into a branch at one of its ends [pu]: own times the voltage there + other times that at the far
/// end.
struct BranchEnd {
  Complex own, other;
};
BranchEnd branch_end(const Branch& branch, bool at_from);

/// Bus admittance matrix [pu] of branches and shunts alone (what the power flow uses). n x n.
Eigen::SparseMatrix<Complex> bus_admittance(const Network& network, const Topology& topology = {});

/// What a load draws at the power-flow voltage [pu on base_mva].
Complex consumption(const Load& load, const PowerFlow& flow);

/// The same with every load turned into the constant admittance it draws at the power-flow voltage, load
/// steps likewise, and faults through an impedance added. Bolted faults are not in the matrix: see
/// `bolted_buses`. `without`: loads left out, by index, sorted.
Eigen::SparseMatrix<Complex> dynamic_admittance(const Network& network, const PowerFlow& flow,
                                                const Topology& topology,
                                                const std::vector<int>& without = {});
std::vector<int> bolted_buses(const Topology& topology);

/// Kron reduction of `dynamic_admittance` to `kept` buses: I = Y V there, all other buses carry no injection,
/// bolted buses are eliminated with V = 0. Rows and columns of a kept bus that is itself bolted are zero and
/// it is listed in `grounded`. Throws InputError if buses without connection remain.
struct ReducedNetwork {
  Eigen::MatrixXcd y;         ///< kept x kept [pu on base_mva]
  std::vector<int> grounded;  ///< positions in `kept` whose voltage is zero
};
ReducedNetwork reduce(const Network& network, const PowerFlow& flow, const Topology& topology,
                      const std::vector<int>& kept, const std::vector<int>& without = {});

}  // namespace swingbank::sim::network
