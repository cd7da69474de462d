#pragma once
// A noisy record as input of the likelihood: means of the steady state before the event, the samples after
// it, and the intervals that contain a voltage step.
#include <array>
#include <map>
#include <vector>

#include "sim/core/recording.hpp"
#include "sim/core/scalar.hpp"

namespace swingbank::sim::direct {

/// Compared signals, in this order; Ifd only if recorded.
enum Output { kP, kQ, kSpeed, kIfd, kOutputs };
/// Played-in signals, which are noisy too.
enum Input { kV, kTheta, kInputs };
/// Largest number of states: one dual holds the states and the input noise.
constexpr std::size_t kMostFlowing = kSensitivities - kInputs;

using Inputs = std::array<double, kInputs>;

/// Played-in voltage between one sample and the next.
struct Interval {
  Inputs middle = {};              ///< by a cubic through four neighbours on the smooth side
  bool leaps = false;              ///< whether there is a step at an unknown time in between
  Inputs before = {}, after = {};  ///< in case of a step, taken in the middle: both sides, linear
};

/// Correction of a machine's states where the played-in signals leave them undetermined [the states' units].
using Correction = std::array<double, kMostFlowing>;

struct NoisyRecord {
  Conventions conventions;
  MeasurementNoise noise;
  double step = 0;         ///< [s]
  double first_step = 0;   ///< from the event's start to the first sample after it [s]
  int outputs = kOutputs;  ///< number of compared signals
  /// Means and number of the samples before the event. theta is relative to its mean.
  double P0 = 0, Q0 = 0, V0 = 0, Ifd0 = 0;
  double before = 0;
  /// Samples after the event's start.
  std::vector<Inputs> in;
  std::vector<std::array<double, kOutputs>> out;
  std::vector<Interval> behind;             ///< interval after each sample but the last
  Inputs at_event = {}, end_of_first = {};  ///< of the step from the event, whose first is a straight line's
  /// Added to the states at the first sample and after a step; zero in a record as measured.
  Correction at_first = {};
  std::map<std::size_t, Correction> behind_leap;

  [[nodiscard]] std::size_t samples() const { return in.size(); }
};

/// Computes the played-in voltage between the samples of `in`, once `leaps` is set in each interval.
void fill_intervals(NoisyRecord& record);
/// Returns the record with a segment of at most `longest` [s] after the event.
NoisyRecord noisy_record(const Recording& record, double longest);

}  // namespace swingbank::sim::direct
