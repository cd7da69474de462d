#pragma once
// Controls of a plant simulated open loop: their inputs are those of an earlier run, so that their field
// voltage or torque does not feed back. Eight plants ride in the lanes of a pack, in fixed steps.
#include <Eigen/Dense>
#include <array>
#include <span>
#include <vector>

#include "validate/playin/driven_plant.hpp"

namespace swingbank::validate::playin {

/// Output of a plant's controls.
enum class Made { field, torque };

class OpenLoop {
 public:
  /// Where the response is known: the given times from the first switching time (none: from the first of
  /// them) on, and both sides of every switching time. Before that the controls are in steady state.
  struct TimePoint {
    double t;     ///< [s]
    int segment;  ///< of the voltage curve
  };
  /// `times`: where steps end [s].
  OpenLoop(SeenAlong run, const std::vector<double>& times, const sim::Conventions& conventions);

  /// Where the steps from one of these times to the next look at their inputs: the signals should be known
  /// there.
  [[nodiscard]] static std::vector<double> looks(const std::vector<double>& times);

  [[nodiscard]] const std::vector<TimePoint>& times() const { return times_; }
  /// Efd or Tm [pu] at [time point][plant] of plants with the recorded machine (playin/component.hpp) that
  /// differ in values only. A column is NaN where its plant has no steady state at the start, and not finite
  /// where it cannot be integrated.
  [[nodiscard]] Eigen::MatrixXd run(Made made, std::span<const sim::plant::Plant> plants) const;

 private:
  struct Step {
    double h;  ///< to the next time point [s]; 0: that one is on the other side of a switching time
    Seen begin;
    std::array<Seen, 3> stages = {};  ///< of the formula, after the first
  };
  [[nodiscard]] Seen between(int segment, double t) const;

  Seen standing_;
  std::vector<Seen> seen_;
  std::vector<std::size_t> first_of_;  ///< segment's first entry in `seen_`, and the end
  sim::Conventions conventions_;
  std::vector<TimePoint> times_;
  std::vector<Step> steps_;  ///< from each time point but the last
};

}  // namespace swingbank::validate::playin
