#pragma once
// What one switching or one machine's impedance changes in the reduced network: few outer products.
#include <functional>
#include <optional>

#include "sim/lanes/detail/internal_network.hpp"

namespace swingbank::sim::lanes {

/// sum_k u_k w_k^T. Of every factor real and imaginary parts, one vector after the other.
struct LowRank {
  int rank = 0;
  std::vector<double> ur, ui, wr, wi;  ///< [k][row], [k][column]
  void add(const Complex& u, const Complex& w) {
    ur.push_back(u.real());
    ui.push_back(u.imag());
    wr.push_back(w.real());
    wi.push_back(w.imag());
  }
};

/// matrix - from, by elimination with full pivoting until the largest entry left is rounding; none where that
/// takes more than `most` products.
std::optional<LowRank> difference(const InternalMatrix& matrix, const InternalMatrix& from, int most);

struct ImpedanceChange {
  int source;
  Complex dz;  ///< [pu on its own base]
};
/// A matrix by its rows and columns, as they are asked for.
struct ByRowsAndColumns {
  std::function<Eigen::VectorXcd(int)> row, column;
};
/// Adds to the products of M = matrix + products what other impedances of some sources C change:
/// -M[:,C] (1 + dZ M[C,C])^-1 dZ M[C,:]. That saves the solution of the whole network for every set of
/// machines.
void add_impedances(LowRank& products, const ByRowsAndColumns& matrix,
                    const std::vector<ImpedanceChange>& changes);
void add_impedances(LowRank& products, const InternalMatrix& matrix,
                    const std::vector<ImpedanceChange>& changes);

}  // namespace swingbank::sim::lanes
