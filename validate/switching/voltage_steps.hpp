#pragma once
// Steps of the voltage phasor over the sample intervals of a record, and the switching times that they
// determine.
#include <cstddef>
#include <vector>

#include "validate/switching/switching.hpp"

namespace swingbank::validate::switching {

/// Changes of a record's voltage phasor over its sample intervals.
class VoltageSteps {
 public:
  /// Computes the changes of a record, which must outlive this object.
  explicit VoltageSteps(const record::Record& record) : VoltageSteps(record, record.theta) {}
  /// The same with another angle [rad].
  VoltageSteps(const record::Record& record, const std::vector<double>& theta);

  /// Change over each sample interval [pu].
  [[nodiscard]] const std::vector<Complex>& changes() const { return step_; }

  /// Finds the sample intervals with a voltage step. The change over such an interval differs from both
  /// neighbouring changes by more than `threshold` [pu] and more than ten times the median difference
  /// (noise). Each switching time is the middle of its interval, with half the interval as uncertainty. If
  /// there are no such intervals, finds small isolated steps, as from the loss of a distant generator. Such a
  /// step deviates from the extrapolated voltage by at least a twentieth of `threshold`. Over ten samples on
  /// either side, or to the start of the record, no deviation due to noise or a swing exceeds a fifth of the
  /// step's deviation.
  [[nodiscard]] std::vector<Switching> detect(double threshold = kStepThreshold) const;

  /// Finds switchings, also if a filter has spread their steps over two or three sample intervals. With
  /// StepShape::filtered, the neighbours of sharp steps are marked as filtered too; with StepShape::sharp, a
  /// step over several intervals is interpreted as a swing and ignored, unless one interval dominates.
  [[nodiscard]] SwitchingTimes find(double threshold, StepShape shape) const;

  /// Returns the shape of the record's first step; `either` if the step is not conclusive. The window of a
  /// filter is symmetric, so it spreads a step equally to both sides. A decay on one side only is the
  /// machine's subtransient response. Later steps may belong to swings. `found`: switchings found with
  /// StepShape::either.
  [[nodiscard]] StepShape shape_of_first(const std::vector<Switching>& found, double threshold) const;

  /// Returns whether the voltage changes before the sample interval of the first given switching time.
  [[nodiscard]] bool moves_before_given(double threshold) const;

 private:
  [[nodiscard]] Switching within_step(std::size_t k) const;
  [[nodiscard]] std::vector<Switching> isolated_steps(double threshold) const;
  [[nodiscard]] double min_step_size(double threshold) const;
  [[nodiscard]] bool is_shared_out(const Switching& switching) const;
  [[nodiscard]] bool is_sharp(const Switching& first, double threshold) const;
  const record::Record* record_;
  std::vector<Complex> step_;
  std::vector<double> prominence_;  ///< distance of each change from those around it [pu]
};

/// Returns the change of the voltage phasor over each sample interval [pu].
inline std::vector<Complex> voltage_steps(const record::Record& record) {
  return VoltageSteps(record).changes();
}
/// Finds the steps of a record that no filter has spread, see VoltageSteps::detect().
inline std::vector<Switching> detect_switchings(const record::Record& record,
                                                double threshold = kStepThreshold) {
  return VoltageSteps(record).detect(threshold);
}

}  // namespace swingbank::validate::switching
