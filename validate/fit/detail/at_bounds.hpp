#pragma once
// Numbers of a search that stand at a bound and are drawn beyond it are held there while the others go on. A
// step that bounds cut short need not lead down, so a search ends on it though a way down is left.
#include <ceres/ceres.h>

#include <map>
#include <vector>

namespace swingbank::validate::fit::fitting {

class AtBounds {
 public:
  explicit AtBounds(ceres::Problem& problem) : problem_(problem) {}
  /// These numbers of a block never move.
  void fix(double* block, std::vector<int> which);
  /// Holds what stands at a bound and is drawn beyond it. False where nothing is, or what was held before.
  bool hold();
  /// Only what never moves stays.
  void release();

 private:
  using Which = std::map<double*, std::vector<int>>;  ///< of each block, ascending
  [[nodiscard]] bool any_at_bound() const;
  [[nodiscard]] double beyond(double* block, int i) const;
  void apply(double* block, const std::vector<int>& which);

  ceres::Problem& problem_;
  Which fixed_, held_;
};

}  // namespace swingbank::validate::fit::fitting
