#pragma once
// Sparsity pattern of a segment's Jacobian: entries that have been nonzero in the run. A unit's block is
// dense in the full pattern, but most of its entries are always zero. Units with the same effects share their
// pattern.
#include "sim/reference/detail/system.hpp"

namespace swingbank::sim::reference {

/// For each kind of unit (ReferencePlants::Unit::kind): 1 for each entry of its block, column by column, that
/// was nonzero.
using SeenEntries = std::vector<std::vector<char>>;

class Nonzeros {
 public:
  /// `seen`: entries that were nonzero in the run; take() updates it.
  Nonzeros(const ReferenceSystem& system, SeenEntries& seen);
  /// Adds the nonzero entries of `values`, given in the order of the system's pattern. Returns true if the
  /// pattern changed. Entries are never removed.
  bool take(const std::vector<double>& values);
  [[nodiscard]] int count() const { return static_cast<int>(kept_.size()); }
  /// Writes the pattern in compressed columns.
  template <class Index>
  void pattern(Index* outer, Index* inner) const {
    std::copy(outer_.begin(), outer_.end(), outer);
    for (std::size_t k = 0; k < kept_.size(); ++k) inner[k] = full_pattern_.innerIndexPtr()[kept_[k]];
  }
  /// Writes the values of the pattern's entries.
  void gather(const std::vector<double>& values, double* to) const {
    for (std::size_t k = 0; k < kept_.size(); ++k) to[k] = values[static_cast<std::size_t>(kept_[k])];
  }

 private:
  const ReferenceSystem& system_;
  const Eigen::SparseMatrix<double>& full_pattern_;
  SeenEntries& seen_;
  std::vector<char> taken_;  ///< for each entry of the full pattern: 1 if it is in this pattern
  std::vector<int> kept_;    ///< positions in the full pattern, ascending
  std::vector<int> outer_;
};

}  // namespace swingbank::sim::reference
