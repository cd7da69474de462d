#pragma once
// Controls of a plant simulated open loop: their inputs are those of an earlier run, so that their field
// voltage or torque does not feed back. Eight plants ride in the lanes of a pack, in fixed steps.
#include <Eigen/Dense>
#include <span>
#include <vector>

#include "validate/playin/driven_plant.hpp"

namespace swingbank::validate::playin {

/// Output of a plant's controls.
enum class Made { field, torque };

class OpenLoop {
 public:
  /// Where the response is known: every sample from the first switching time (none: from the first sample)
  /// on, and both sides of every switching time. Before that the controls are in steady state.
  struct TimePoint {
    double t;     ///< [s]
    int segment;  ///< of the voltage curve
  };
  /// `seen`: along the run; `samples`: of its record [s].
  OpenLoop(std::vector<Seen> seen, const std::vector<double>& samples, const sim::Conventions& conventions);

  [[nodiscard]] const std::vector<TimePoint>& times() const { return times_; }
  /// Efd or Tm [pu] at [time point][plant] of plants with the recorded machine (playin/component.hpp) that
  /// differ in values only. A column is NaN where its plant has no steady state at the start, and not finite
  /// where it cannot be integrated.
  [[nodiscard]] Eigen::MatrixXd run(Made made, std::span<const sim::plant::Plant> plants) const;

 private:
  struct Step {
    double h;  ///< to the next time point [s]; 0: that one is on the other side of a switching time
    Seen begin, middle, end;
  };
  [[nodiscard]] Seen between(int segment, double t) const;

  std::vector<Seen> seen_;
  std::vector<std::size_t> first_of_;  ///< segment's first entry in `seen_`, and the end
  sim::Conventions conventions_;
  std::vector<TimePoint> times_;
  std::vector<Step> steps_;  ///< from each time point but the last
};

}  // namespace swingbank::validate::playin
