#pragma once
// A record with measurement noise, as the likelihood of a machine reads it: the steady state before the event
// as means, the samples from there on, and where the voltage leaps between two of them.
#include <array>
#include <map>
#include <vector>

#include "sim/core/recording.hpp"
#include "sim/core/scalar.hpp"

namespace swingbank::sim::direct {

/// What is compared, in this order; Ifd only where it is recorded.
enum Output { kP, kQ, kSpeed, kIfd, kOutputs };
/// What is played in and noisy as well.
enum Input { kV, kTheta, kInputs };
/// So that one dual holds the states and the input's noise.
constexpr std::size_t kMostFlowing = kDirections - kInputs;

using Inputs = std::array<double, kInputs>;

/// The voltage between one sample and the next.
struct Interval {
  Inputs middle = {};  ///< by a cubic through four neighbours, on whose smooth side there is no leap
  bool leaps = false;  ///< somewhere between the two, nobody knows where
  Inputs before = {}, after = {};  ///< where it leaps in the middle: on both sides, by straight lines
};

/// Where what is played in leaves a machine's state open: what the samples say of it [the states' units].
using Correction = std::array<double, kMostFlowing>;

struct NoisyRecord {
  Conventions conventions;
  MeasurementNoise noise;
  double step = 0;         ///< [s]
  double first_step = 0;   ///< from the event's beginning to the first sample behind it [s]
  int outputs = kOutputs;  ///< how many of Output
  /// Means over the samples before the event, and how many there are. theta counts from its own mean.
  double P0 = 0, Q0 = 0, V0 = 0, Ifd0 = 0;
  double before = 0;
  /// Of the samples behind the event's beginning.
  std::vector<Inputs> in;
  std::vector<std::array<double, kOutputs>> out;
  std::vector<Interval> behind;             ///< each sample but the last
  Inputs at_event = {}, end_of_first = {};  ///< of the step from the event, whose first is a straight line's
  /// Added to the state at the first sample, and behind a leap; zero in a record as measured.
  Correction at_first = {};
  std::map<std::size_t, Correction> behind_leap;

  [[nodiscard]] std::size_t samples() const { return in.size(); }
};

/// `longest`: of the stretch behind the event [s].
/// What lies between the samples of `in`, once `leaps` is known of each interval.
void fill_intervals(NoisyRecord& record);
NoisyRecord noisy_record(const Recording& record, double longest);

}  // namespace swingbank::sim::direct
