#pragma once
// Active set of bounds in a Ceres problem. A variable at a bound is fixed while the others move, if a move of
// this variable beyond the bound would reduce the cost. Ceres projects steps onto the bounds. A projected
// step need not reduce the cost, so a search without an active set may end before the optimum.
#include <ceres/ceres.h>

#include <map>
#include <vector>

namespace swingbank::validate::fit::fitting {

/// Fixes variables of a Ceres problem at their bounds.
class AtBounds {
 public:
  explicit AtBounds(ceres::Problem& problem) : problem_(problem) {}
  /// Fixes these variables of a block for the whole search.
  void fix(double* block, std::vector<int> which);
  /// Fixes the variables at a bound beyond which the cost would decrease. Returns false if no variable is at
  /// a bound, or if the active set has not changed.
  bool activate();
  /// Releases the variables of the active set; those of fix() stay fixed.
  void release();

 private:
  using Which = std::map<double*, std::vector<int>>;  ///< indices per block, ascending
  [[nodiscard]] bool any_at_bound() const;
  [[nodiscard]] double beyond(double* block, int i) const;
  void apply(double* block, const std::vector<int>& which);

  ceres::Problem& problem_;
  Which fixed_, active_;
};

}  // namespace swingbank::validate::fit::fitting
