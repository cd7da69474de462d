#pragma once
// A record with measurement noise, as the likelihood of a machine reads it: the steady state before the event
// as means, the samples from there on, and where the voltage leaps between two of them.
#include <array>
#include <vector>

#include "sim/core/recording.hpp"

namespace swingbank::sim::direct {

/// What is compared, in this order; Ifd only where it is recorded.
enum Output { kP, kQ, kSpeed, kIfd, kOutputs };
/// What is played in and noisy as well.
enum Input { kV, kTheta, kInputs };

using Inputs = std::array<double, kInputs>;

/// The voltage between one sample and the next.
struct Interval {
  Inputs middle = {};  ///< by a cubic through four neighbours, on whose smooth side there is no leap
  bool leaps = false;  ///< somewhere between the two, nobody knows where
  Inputs before = {}, after = {};  ///< where it leaps in the middle: on both sides, by straight lines
};

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
  std::vector<Interval> behind;  ///< each sample but the last
  Inputs at_event = {};          ///< when the event has just begun, by a straight line

  [[nodiscard]] std::size_t samples() const { return in.size(); }
};

/// `longest`: of the stretch behind the event [s].
NoisyRecord noisy_record(const Recording& record, double longest);

}  // namespace swingbank::sim::direct
