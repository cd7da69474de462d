#pragma once
// Which entries of a segment's Jacobian have ever been other than zero in the run: every unit has room for
// all of its unknowns by all, and most of that stays empty. What one unit shows counts for all units made of
// the same effects.
#include "sim/reference/detail/system.hpp"

namespace swingbank::sim::reference {

/// Per kind of unit (ReferencePlants::Unit::kind): 1 where an entry of its block, column by column, was not
/// zero.
using SeenEntries = std::vector<std::vector<char>>;

class Nonzeros {
 public:
  /// seen: of the run; kept up to date.
  Nonzeros(const ReferenceSystem& system, SeenEntries& seen);
  /// Takes in what is not zero among values in the order of the system's pattern; true if the pattern is
  /// another than before. An entry never goes out.
  bool take(const std::vector<double>& values);
  [[nodiscard]] int count() const { return static_cast<int>(kept_.size()); }
  /// Writes the pattern in compressed columns.
  template <class Index>
  void pattern(Index* outer, Index* inner) const {
    std::copy(outer_.begin(), outer_.end(), outer);
    for (std::size_t k = 0; k < kept_.size(); ++k) inner[k] = room_.innerIndexPtr()[kept_[k]];
  }
  /// Writes the values of the pattern's entries.
  void gather(const std::vector<double>& values, double* to) const {
    for (std::size_t k = 0; k < kept_.size(); ++k) to[k] = values[static_cast<std::size_t>(kept_[k])];
  }

 private:
  const ReferenceSystem& system_;
  const Eigen::SparseMatrix<double>& room_;
  SeenEntries& seen_;
  std::vector<char> taken_;  ///< per entry of the room
  std::vector<int> kept_;    ///< places in the room, ascending
  std::vector<int> outer_;
};

}  // namespace swingbank::sim::reference
