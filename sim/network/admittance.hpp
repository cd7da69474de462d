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

/// What a matrix holds of the ties (tie.hpp): everything, or no series impedance of theirs.
enum class TiesIn { matrix, equations };

/// Bus admittance matrix [pu] of branches and shunts alone (what the power flow uses). n x n.
Eigen::SparseMatrix<Complex> bus_admittance(const Network& network, const Topology& topology = {},
                                            TiesIn ties = TiesIn::matrix);

/// What a load draws at the power-flow voltage [pu on base_mva].
Complex consumption(const Load& load, const PowerFlow& flow);

/// The same with every load turned into the constant admittance it draws at the power-flow voltage, load
/// steps likewise, and faults through an impedance added. Bolted faults are not in the matrix: see
/// `grounded_buses`. `without`: loads left out, by index, sorted. Throws InputError where no generator is
/// connected any more, or an island of the network has none without anything being tripped.
Eigen::SparseMatrix<Complex> dynamic_admittance(const Network& network, const PowerFlow& flow,
                                                const Topology& topology,
                                                const std::vector<int>& without = {},
                                                TiesIn ties = TiesIn::matrix);
/// Buses of islands without a connected generator: a trip has cut them off and their loads are shed. Sorted.
std::vector<int> dead_buses(const Network& network, const Topology& topology);
/// Buses held at V = 0, by a bolted fault or because they are dead. Sorted.
std::vector<int> grounded_buses(const Network& network, const Topology& topology);

/// Kron reduction of `dynamic_admittance` to `kept` buses: I = Y V there, all other buses carry no injection,
/// grounded buses are eliminated with V = 0. Rows and columns of a kept bus that is itself grounded are zero
/// and it is listed in `grounded`. Throws InputError if buses without connection remain.
struct ReducedNetwork {
  Eigen::MatrixXcd y;         ///< kept x kept [pu on base_mva]
  std::vector<int> grounded;  ///< positions in `kept` whose voltage is zero
};
ReducedNetwork reduce(const Network& network, const PowerFlow& flow, const Topology& topology,
                      const std::vector<int>& kept, const std::vector<int>& without = {});

}  // namespace swingbank::sim::network
