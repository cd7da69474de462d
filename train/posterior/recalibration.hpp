#pragma once
// Recalibration of normal scores by rows that were not used in training. A normal score is the standard
// normal quantile of a value's cumulative probability under the posterior. The map is monotone and piecewise
// linear, and makes the scores of these rows standard normal (Kuleshov, Fenner and Ermon 2018).
#include <array>
#include <span>

namespace swingbank::train::posterior {

/// Probabilities of the map's nodes, between which it is linear.
inline constexpr std::array<double, 11> kNodeProbabilities = {0.01,  0.05, 0.125, 0.25, 0.375, 0.5,
                                                              0.625, 0.75, 0.875, 0.95, 0.99};

class Recalibration {
 public:
  Recalibration();  ///< the identity
  /// Fits the map. `scores`: normal scores of the true values under the posteriors. With fewer than 20
  /// scores, returns the identity.
  static Recalibration fit(std::span<const double> scores);
  /// `node_scores`: scores at kNodeProbabilities.
  explicit Recalibration(const std::array<double, kNodeProbabilities.size()>& node_scores)
      : node_scores_(node_scores) {}
  [[nodiscard]] const std::array<double, kNodeProbabilities.size()>& node_scores() const {
    return node_scores_;
  }
  /// Returns the recalibrated score.
  [[nodiscard]] double recalibrated(double score) const;
  /// Inverse of recalibrated().
  [[nodiscard]] double original(double recalibrated_score) const;
  /// Returns the map (1 - share) a + share b.
  static Recalibration between(const Recalibration& a, const Recalibration& b, double share);

 private:
  std::array<double, kNodeProbabilities.size()> node_scores_{};
};

}  // namespace swingbank::train::posterior
