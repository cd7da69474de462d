#include "train/posterior/recalibration.hpp"

#include <algorithm>
#include <vector>

#include "train/posterior/normal.hpp"

namespace swingbank::train::posterior {
namespace {

constexpr std::size_t kNodeCount = kNodeProbabilities.size();
using NodeScores = std::array<double, kNodeCount>;

const NodeScores& standard() {
  static const NodeScores scores = [] {
    NodeScores all{};
    for (std::size_t i = 0; i < kNodeCount; ++i) all[i] = normal_quantile(kNodeProbabilities[i]);
    return all;
  }();
  return scores;
}

/// Interpolates linearly between the points (from, to). Extrapolates with the slope between the outermost
/// point and the second point inwards from it.
double along(const NodeScores& from, const NodeScores& to, double x) {
  const auto slope = [&](std::size_t a, std::size_t b) { return (to[b] - to[a]) / (from[b] - from[a]); };
  if (x <= from.front()) return to.front() + (x - from.front()) * slope(0, 2);
  if (x >= from.back()) return to.back() + (x - from.back()) * slope(kNodeCount - 3, kNodeCount - 1);
  const auto after = static_cast<std::size_t>(std::ranges::upper_bound(from, x) - from.begin());
  return to[after - 1] + (x - from[after - 1]) * slope(after - 1, after);
}

}  // namespace

Recalibration::Recalibration() : node_scores_(standard()) {}

Recalibration Recalibration::fit(std::span<const double> scores) {
  constexpr std::size_t kMinRows = 20;
  constexpr double kClosest = 1e-3;  // smallest distance of nodes, so that the map has an inverse
  Recalibration r;
  if (scores.size() < kMinRows) return r;
  std::vector<double> sorted(scores.begin(), scores.end());
  std::ranges::sort(sorted);
  for (std::size_t i = 0; i < kNodeCount; ++i) {
    const double at = kNodeProbabilities[i] * static_cast<double>(sorted.size() - 1);
    const auto left = std::min(static_cast<std::size_t>(at), sorted.size() - 2);
    r.node_scores_[i] = std::lerp(sorted[left], sorted[left + 1], at - static_cast<double>(left));
    if (i > 0) r.node_scores_[i] = std::max(r.node_scores_[i], r.node_scores_[i - 1] + kClosest);
  }
  return r;
}

double Recalibration::recalibrated(double score) const { return along(node_scores_, standard(), score); }
double Recalibration::original(double recalibrated_score) const {
  return along(standard(), node_scores_, recalibrated_score);
}

Recalibration Recalibration::between(const Recalibration& a, const Recalibration& b, double share) {
  Recalibration r;
  for (std::size_t i = 0; i < kNodeCount; ++i)
    r.node_scores_[i] = std::lerp(a.node_scores_[i], b.node_scores_[i], share);
  return r;
}

}  // namespace swingbank::train::posterior
