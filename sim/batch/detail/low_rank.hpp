#pragma once
// Low-rank updates of the reduced network's matrix, caused by a switching or by a change of a machine's
// impedance.
#include <functional>
#include <optional>

#include "sim/batch/detail/internal_network.hpp"

namespace swingbank::sim::batch {

/// A sum of outer products sum_k u_k w_k^T. The vectors are stored one after the other, as real and imaginary
/// parts.
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

/// Returns matrix - from as outer products, by elimination with full pivoting. The elimination stops when the
/// largest remaining entry is a rounding error. Returns none if this needs more than `most` products.
std::optional<LowRank> difference(const InternalMatrix& matrix, const InternalMatrix& from, int most);

struct ImpedanceChange {
  int source;
  Complex dz;  ///< change of the impedance [pu on the source's base]
};
/// A matrix with access by rows and columns, computed on demand.
struct ByRowsAndColumns {
  std::function<Eigen::VectorXcd(int)> row, column;
};
/// Adds to `products` the update of M = matrix + products by changed impedances of the sources C (Woodbury):
/// -M[:,C] (1 + dZ M[C,C])^-1 dZ M[C,:] with the changes dZ. This avoids a solution of the whole network for
/// every set of machine parameters.
void add_impedances(LowRank& products, const ByRowsAndColumns& matrix,
                    const std::vector<ImpedanceChange>& changes);
void add_impedances(LowRank& products, const InternalMatrix& matrix,
                    const std::vector<ImpedanceChange>& changes);

}  // namespace swingbank::sim::batch
