#pragma once
// What a change of the model would gain beside a fitted structure, before anything is fitted: the score test
// (Rao, Proc. Cambridge Philos. Soc. 44, 1948, p. 50). Whatever the structure's own parameters and the
// events' instants and starts could do is taken out of the change.
#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "validate/fit.hpp"

namespace swingbank::validate {

class ScoreTest {
 public:
  /// `fit` of `plant`, at its minimum. Costs one look at all slopes.
  ScoreTest(const std::vector<FitEvent>& events, const sim::Plant& plant, const sim::Conventions& conventions,
            const Fit& fit);

  /// A change of the answer, whitened, one event after the other; and what the structure could do of it.
  struct Change {
    Eigen::VectorXd answer, shared;
    double along = 0;   ///< slope of half the cost at no change; negative: it helps
    double square = 0;  ///< what is left of it, squared
    double whole = 0;   ///< before anything was taken out, squared
    /// By how much chi2 would fall, were the answer straight.
    [[nodiscard]] double gain() const { return square > 0 && along < 0 ? along * along / square : 0.0; }
    /// By how much chi2 would rise with all of the change.
    [[nodiscard]] double rise() const { return square + 2 * along; }
    /// How much of the change would be best.
    [[nodiscard]] double share() const { return square > 0 ? -along / square : 0.0; }
  };
  /// From the structure's answer to that of another plant; none if that cannot be run.
  [[nodiscard]] std::optional<Change> change_to(const sim::Plant& plant,
                                                const sim::Conventions& conventions) const;
  /// Slopes of another plant's answer, which should be near the structure's; empty if it cannot be run.
  [[nodiscard]] std::vector<Change> slopes(const sim::Plant& plant, const sim::Conventions& conventions,
                                           const std::vector<Direction>& along) const;
  /// By how much chi2 would fall by the best combination of these changes, less what noise alone would give
  /// it: 1 a direction. Directions in which they hardly differ are left out.
  [[nodiscard]] double joint_gain(const std::vector<Change>& changes) const;

 private:
  /// Answers (less the measured ones) and slopes of a run, whitened: [value][0: answer, then slopes].
  [[nodiscard]] std::optional<Eigen::MatrixXd> run(const sim::Plant& plant,
                                                   const sim::Conventions& conventions,
                                                   const std::vector<Direction>& along) const;
  [[nodiscard]] Change less_shared(Eigen::VectorXd answer) const;

  const std::vector<FitEvent>& events_;
  const Fit& fit_;
  Eigen::VectorXd residual_;            ///< whitened
  Eigen::MatrixXd slopes_;              ///< [value][parameter, then each event's own]
  Eigen::LDLT<Eigen::MatrixXd> known_;  ///< slopes' and beliefs' curvature
  Eigen::VectorXd gradient_;            ///< of half the cost: what the fit left over
};

}  // namespace swingbank::validate
