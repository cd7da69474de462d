#pragma once
// Admittance matrices: the bus matrix with constant-impedance loads, faults and open branches, and its Kron
// reduction to chosen buses.
#include <Eigen/Dense>
#include <Eigen/Sparse>

#include "sim/network/event.hpp"
#include "sim/network/powerflow.hpp"

namespace swingbank::sim::network {

/// Admittances of a branch seen from one end [pu]: current into the branch = own V_here + other V_far.
struct BranchEnd {
  Complex own, other;  ///< own and transfer admittance [pu]
};
/// Returns the admittances seen from the `from` end, or from the `to` end.
BranchEnd branch_end(const Branch& branch, bool at_from);

/// Place of the series impedances of ties (tie.hpp): in the matrix, or in separate equations outside it.
enum class TiesIn { matrix, equations };

/// Returns the n x n bus admittance matrix [pu] of branches and shunts only, as used by the power flow.
Eigen::SparseMatrix<Complex> bus_admittance(const Network& network, const Topology& topology = {},
                                            TiesIn ties = TiesIn::matrix);

/// Returns the power of a load at the power-flow voltage [pu on base_mva].
Complex consumption(const Load& load, const PowerFlow& flow);

/// Returns the bus admittance matrix [pu] for dynamics. Every load and load step is the constant admittance
/// that draws its power at the power-flow voltage. The matrix contains faults through an impedance, but not
/// bolted faults (see `grounded_buses`). `without`: sorted indices of loads that are left out. Throws
/// InputError if no generator is connected, or if an island has no generator although nothing was tripped.
Eigen::SparseMatrix<Complex> dynamic_admittance(const Network& network, const PowerFlow& flow,
                                                const Topology& topology,
                                                const std::vector<int>& without = {},
                                                TiesIn ties = TiesIn::matrix);
/// Returns the buses of islands that a trip has left without a generator, sorted. Their loads are shed.
std::vector<int> dead_buses(const Network& network, const Topology& topology);
/// Returns the buses at V = 0, sorted: buses with a bolted fault, and dead_buses().
std::vector<int> grounded_buses(const Network& network, const Topology& topology);

/// Kron reduction of `dynamic_admittance` to the `kept` buses: I = Y V. No current is injected at any other
/// bus. Grounded buses are eliminated with V = 0. Rows and columns of a kept bus that is grounded are zero,
/// and `grounded` lists it. Throws InputError if the matrix of the eliminated buses is singular.
struct ReducedNetwork {
  Eigen::MatrixXcd y;         ///< kept x kept [pu on base_mva]
  std::vector<int> grounded;  ///< positions in `kept` with zero voltage
};
/// Computes the reduction. `without`: sorted indices of loads that are left out.
ReducedNetwork reduce(const Network& network, const PowerFlow& flow, const Topology& topology,
                      const std::vector<int>& kept, const std::vector<int>& without = {});

}  // namespace swingbank::sim::network
