#pragma once
// A belief's normal scores set right by rows that did not train: an increasing map, straight between
// quantiles, after which the scores of these rows are standard normal (Kuleshov, Fenner and Ermon 2018).
#include <array>
#include <span>

namespace swingbank::train::posterior {

/// Probabilities at which the map is held, and between which it is straight.
inline constexpr std::array<double, 11> kHeldAt = {0.01,  0.05, 0.125, 0.25, 0.375, 0.5,
                                                   0.625, 0.75, 0.875, 0.95, 0.99};

class Recalibration {
 public:
  Recalibration();  ///< leaves scores as they are
  /// `scores`: of the truths under the beliefs, 20 or more; fewer leave scores as they are.
  static Recalibration fit(std::span<const double> scores);
  /// Scores at kHeldAt.
  explicit Recalibration(const std::array<double, kHeldAt.size()>& held) : held_(held) {}
  [[nodiscard]] const std::array<double, kHeldAt.size()>& held() const { return held_; }
  [[nodiscard]] double right(double score) const;
  /// The opposite.
  [[nodiscard]] double wrong(double right) const;
  /// Between two maps: `share` of the second.
  static Recalibration between(const Recalibration& a, const Recalibration& b, double share);

 private:
  std::array<double, kHeldAt.size()> held_{};
};

}  // namespace swingbank::train::posterior
