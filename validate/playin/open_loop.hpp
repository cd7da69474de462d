#pragma once
// Open-loop simulation of a plant's controls: their inputs are those of an earlier run, without feedback of
// their field voltage or torque. SIMD batches of eight plants, fixed steps.
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
  /// Times of the response: `times` from the first switching time on (without switchings, all), and both
  /// sides of every switching time. Before that the controls are in steady state.
  struct TimePoint {
    double t;     ///< [s]
    int segment;  ///< of the voltage curve
  };
  /// `times`: ends of the steps [s].
  OpenLoop(SeenAlong run, const std::vector<double>& times, const sim::Conventions& conventions);

  /// Returns the times within the steps between `times` at which the formula evaluates the inputs [s]. The
  /// signals should be known there.
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
    std::size_t length = 0;           ///< number of h in `lengths_`, if h > 0
    std::array<Seen, 3> stages = {};  ///< inputs at the formula's stages after the first
  };
  [[nodiscard]] Seen between(int segment, double t) const;

  Seen steady_;
  std::vector<Seen> seen_;
  std::vector<std::size_t> first_of_;  ///< first entry of each segment in `seen_`, then the end
  sim::Conventions conventions_;
  std::vector<TimePoint> times_;
  std::vector<Step> steps_;      ///< from each time point but the last
  std::vector<double> lengths_;  ///< different lengths of the steps [s]
};

}  // namespace swingbank::validate::playin
