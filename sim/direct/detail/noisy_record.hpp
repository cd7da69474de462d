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
/// Largest number of states. A dual number has derivatives with respect to the states and the input noise.
constexpr std::size_t kMostFlowing = kSensitivities - kInputs;

using Inputs = std::array<double, kInputs>;

/// Played-in voltage between one sample and the next.
struct Interval {
  Inputs middle = {};              ///< midpoint: cubic through four neighbours, or linear next to a step
  bool leaps = false;              ///< whether the interval contains a step at an unknown time
  Inputs before = {}, after = {};  ///< with a step: voltage before and after it, extrapolated to the midpoint
};

/// Correction of the machine's states at times when the played-in signals do not determine them [units of the
/// states].
using Correction = std::array<double, kMostFlowing>;

struct NoisyRecord {
  Conventions conventions;
  MeasurementNoise noise;
  double step = 0;         ///< sampling interval [s]
  double first_step = 0;   ///< time from the event's start to the next sample [s]
  int outputs = kOutputs;  ///< number of compared signals
  /// Means and number of the samples before the event. theta is relative to its mean.
  double P0 = 0, Q0 = 0, V0 = 0, Ifd0 = 0;
  double before = 0;
  /// Samples after the event's start.
  std::vector<Inputs> in;
  std::vector<std::array<double, kOutputs>> out;
  std::vector<Interval> behind;             ///< interval after each sample but the last
  Inputs at_event = {}, end_of_first = {};  ///< inputs at the event, extrapolated; inputs at the next sample
  /// Corrections that are added to the states at the first sample and after a step. They are zero in a
  /// measured record.
  Correction at_first = {};
  std::map<std::size_t, Correction> behind_leap;

  [[nodiscard]] std::size_t samples() const { return in.size(); }
};

/// Returns a + share (b - a).
Inputs between(const Inputs& a, const Inputs& b, double share);
/// Computes the played-in voltage between the samples of `in`. Requires `leaps` of every interval.
void fill_intervals(NoisyRecord& record);
/// Returns the input of the likelihood, with at most `longest` [s] after the event.
NoisyRecord noisy_record(const Recording& record, double longest);

}  // namespace swingbank::sim::direct
