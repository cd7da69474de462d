#pragma once
// Open-loop simulation of a plant's controls: their inputs are those of an earlier run, without feedback of
// their field voltage or torque. It simulates SIMD batches of eight plants with fixed steps.
#include <Eigen/Dense>
#include <array>
#include <span>
#include <vector>

#include "validate/playin/plant_playback.hpp"

namespace swingbank::validate::playin {

/// Output of a plant's controls.
enum class Made { field, torque };

/// Open-loop simulation of a plant's controls: the machine's signals are given, and no output feeds back.
class OpenLoop {
 public:
  /// A time of the response. The response covers `times` from the first switching time on (all if there is no
  /// switching) and both sides of every later switching time. Before the first switching time, the controls
  /// are in steady state.
  struct TimePoint {
    double t;     ///< [s]
    int segment;  ///< of the voltage curve
  };
  /// `times`: ends of the steps [s].
  OpenLoop(SeenAlong run, const std::vector<double>& times, const sim::Conventions& conventions);

  /// Returns `times` and the times between them at which the integration formula evaluates the inputs [s].
  /// The inputs should be known at these times (see seen_along()).
  [[nodiscard]] static std::vector<double> looks(const std::vector<double>& times);

  [[nodiscard]] const std::vector<TimePoint>& times() const { return times_; }  ///< times of the response
  /// Returns Efd or Tm [pu] at [time point][plant] for plants with the recorded machine
  /// (playin/component.hpp) that differ in values only. A column is NaN if its plant has no steady state at
  /// the start, and not finite if the integration fails.
  [[nodiscard]] Eigen::MatrixXd run(Made made, std::span<const sim::plant::Plant> plants) const;

 private:
  struct Step {
    double h;  ///< to the next time point [s]; 0: across a switching time
    Seen begin;
    std::size_t length = 0;           ///< index of h in `lengths_`, if h > 0
    std::array<Seen, 3> stages = {};  ///< inputs at the formula's stages after the first
  };
  [[nodiscard]] Seen between(int segment, double t) const;

  Seen steady_;
  std::vector<Seen> seen_;
  std::vector<std::size_t> first_of_;  ///< first entry of each segment in `seen_`, then the end
  sim::Conventions conventions_;
  std::vector<TimePoint> times_;
  std::vector<Step> steps_;      ///< one step from each time point except the last
  std::vector<double> lengths_;  ///< distinct lengths of the steps [s]
};

}  // namespace swingbank::validate::playin
