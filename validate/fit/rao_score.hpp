#pragma once
// What a change of the model would gain beside a fitted structure, before anything is fitted: the score test
// (Rao, Proc. Cambridge Philos. Soc. 44, 1948, p. 50). The part of the change that the structure's own
// parameters and the events' instants and starts could make is taken out.
#include <Eigen/Dense>
#include <optional>
#include <span>
#include <vector>

#include "validate/fit/fit.hpp"

namespace swingbank::validate::fit {

class ScoreTest {
 public:
  /// `fit` is that of `plant`, at its minimum and made with the noise of `events`. The constructor takes one
  /// look at all slopes. `lenient`: every run has a lenient search's steps and slopes (event::Playing), which
  /// is enough to tell what is worth a fit.
  ScoreTest(const event::WhitenedEvents& events, const sim::plant::PlantUnderTest& tested, const Fit& fit,
            bool lenient = false);

  /// A change of the whitened answer, one event after the other, and the part of it that the structure could
  /// make itself.
  struct Change {
    Eigen::VectorXd answer, shared;
    double along = 0;   ///< slope of half the cost at no change; negative: it helps
    double square = 0;  ///< squared norm of what is left without that part
    double whole = 0;   ///< squared norm before anything was taken out
    /// By how much chi2 would fall if the answer were straight.
    [[nodiscard]] double gain() const { return square > 0 && along < 0 ? along * along / square : 0.0; }
    /// By how much chi2 would rise with the whole change.
    [[nodiscard]] double rise() const { return square + 2 * along; }
    /// The share of the change that would be best.
    [[nodiscard]] double share() const { return square > 0 ? -along / square : 0.0; }
  };
  /// The change from the structure's answer to that of another plant; none if that plant cannot be run.
  [[nodiscard]] std::optional<Change> change_to(const sim::plant::PlantUnderTest& tested) const;
  /// The same of several plants that differ in values only (event::play_together).
  [[nodiscard]] std::vector<std::optional<Change>> changes_to(std::span<const sim::plant::Plant> plants,
                                                              const sim::Conventions& conventions) const;
  /// Whether the answers of two plants differ by more than other steps make them (thresholds). False where
  /// one cannot be run.
  [[nodiscard]] bool apart(const sim::plant::PlantUnderTest& a, const sim::plant::PlantUnderTest& b) const;
  /// Slopes of another plant's answer, which should be near the structure's. Empty if it cannot be run.
  [[nodiscard]] std::vector<Change> slopes(const sim::plant::PlantUnderTest& tested,
                                           const std::vector<playin::Direction>& along) const;
  /// By how much chi2 would fall by the best combination of these changes, less what noise alone would give
  /// it, which is 1 for each direction. Directions in which the changes hardly differ are left out.
  [[nodiscard]] double joint_gain(const std::vector<Change>& changes) const;

 private:
  /// Answers (less the measured ones) and slopes of a run, whitened: [value][0: answer, then slopes].
  [[nodiscard]] std::optional<Eigen::MatrixXd> run(const sim::plant::PlantUnderTest& tested,
                                                   const std::vector<playin::Direction>& along) const;
  [[nodiscard]] Change less_shared(Eigen::VectorXd answer) const;
  [[nodiscard]] Change changed(Eigen::VectorXd answer) const;

  const event::WhitenedEvents& events_;
  const Fit& fit_;
  bool lenient_;
  Eigen::VectorXd residual_;            ///< whitened
  Eigen::MatrixXd slopes_;              ///< [value][parameter, then each event's own]
  Eigen::LDLT<Eigen::MatrixXd> known_;  ///< slopes' and beliefs' curvature
  Eigen::VectorXd gradient_;            ///< of half the cost: what the fit left over
};

}  // namespace swingbank::validate::fit
