#pragma once
// Controls of a plant by themselves, driven by what they saw along a run: eight plants at once, in fixed
// steps. What they answer is the field voltage or the torque, which then acts on nothing that they see.
#include <Eigen/Dense>
#include <span>
#include <vector>

#include "validate/playin/driven_plant.hpp"

namespace swingbank::validate::playin {

/// What a plant's controls make.
enum class Made { field, torque };

class OpenLoop {
 public:
  /// A moment at which the answer is known: both sides of every instant, and every sample from the first
  /// instant (none: from the first sample) on. Before that nothing has moved.
  struct Moment {
    double t;     ///< [s]
    int segment;  ///< of the voltage curve
  };
  /// `seen`: along the run; `samples`: of its record [s].
  OpenLoop(std::vector<Seen> seen, const std::vector<double>& samples, const sim::Conventions& conventions);

  [[nodiscard]] const std::vector<Moment>& moments() const { return moments_; }
  /// Efd or Tm [pu] at [moment][plant] of plants with the recorded machine (playin/component.hpp) that differ
  /// in values only. A column is NaN where its plant cannot stand at the start or cannot be run.
  [[nodiscard]] Eigen::MatrixXd run(Made made, std::span<const sim::plant::Plant> plants) const;

 private:
  struct Step {
    double h;      ///< to the next moment [s]; 0: it is on an instant's other side
    bool settled;  ///< the last instant is long ago
    Seen begin, middle, end;
  };
  [[nodiscard]] Seen between(int segment, double t) const;

  std::vector<Seen> seen_;
  std::vector<std::size_t> first_of_;  ///< segment's first entry in `seen_`, and the end
  sim::Conventions conventions_;
  std::vector<Moment> moments_;
  std::vector<Step> steps_;  ///< from each moment but the last
};

}  // namespace swingbank::validate::playin
