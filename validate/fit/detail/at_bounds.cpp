#include "validate/fit/detail/at_bounds.hpp"

#include <algorithm>

namespace swingbank::validate::fit::fitting {

void AtBounds::fix(double* block, std::vector<int> which) {
  std::ranges::sort(which);
  apply(block, which);
  fixed_[block] = std::move(which);
}

void AtBounds::apply(double* block, const std::vector<int>& which) {
  const int n = problem_.ParameterBlockSize(block);
  if (static_cast<int>(which.size()) == n) return problem_.SetParameterBlockConstant(block);
  problem_.SetParameterBlockVariable(block);
  problem_.SetManifold(block, which.empty() ? nullptr : new ceres::SubsetManifold(n, which));
}

/// Returns -1 at the lower bound, 1 at the upper bound, 0 in between.
double AtBounds::beyond(double* block, int i) const {
  return block[i] <= problem_.GetParameterLowerBound(block, i)   ? -1
         : block[i] >= problem_.GetParameterUpperBound(block, i) ? 1
                                                                 : 0;
}

bool AtBounds::any_at_bound() const {
  return std::ranges::any_of(fixed_, [&](const auto& of) {
    for (int i = 0, n = problem_.ParameterBlockSize(of.first); i < n; ++i)
      if (!std::ranges::binary_search(of.second, i) && beyond(of.first, i) != 0) return true;
    return false;
  });
}

bool AtBounds::activate() {
  if (!any_at_bound()) return false;
  const Which before = active_.empty() ? fixed_ : active_;
  release();
  ceres::Problem::EvaluateOptions some;
  for (const auto& of : fixed_) some.parameter_blocks.push_back(of.first);
  std::vector<double> gradient;
  if (!problem_.Evaluate(some, nullptr, nullptr, &gradient, nullptr)) return false;
  auto derivative = gradient.begin();
  for (const auto& [block, fixed] : fixed_) {
    std::vector<int>& active = active_[block];
    for (int i = 0, n = problem_.ParameterBlockSize(block); i < n; ++i) {
      const bool never_moves = std::ranges::binary_search(fixed, i);
      if (never_moves || *derivative * beyond(block, i) < 0) active.push_back(i);
      if (!never_moves) ++derivative;
    }
    apply(block, active);
  }
  return active_ != before;
}

void AtBounds::release() {
  for (const auto& [block, fixed] : fixed_) apply(block, fixed);
  active_.clear();
}

}  // namespace swingbank::validate::fit::fitting
