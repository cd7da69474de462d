#pragma once
// Statistics of a record's channels for the checks: levels, noise, event time, steadiness before the event.
#include <cstddef>
#include <vector>

#include "validate/record/record.hpp"

namespace swingbank::validate::check {

/// Statistics of one channel, in the record's units.
struct SignalFacts {
  double level = 0;        ///< median before the event (of the whole record if there is none)
  double white = 0;        ///< standard deviation of the white noise
  double quietest = 0;     ///< standard deviation of the quietest second
  double noise = 0;        ///< the larger of `white` and `quietest`
  double reach = 0;        ///< largest distance from the level
  double drift = 0;        ///< change before the event, from a line fitted to these samples
  double drift_error = 0;  ///< standard error of `drift`
  double swing = 0;        ///< standard deviation about the fitted line
};

/// Facts of a record's V, P and Q, and the time of its event.
struct Signals {
  SignalFacts V, P, Q;        ///< statistics of each channel
  bool event = false;         ///< the record contains an event
  bool slow = false;          ///< event without a step, which begins before it is detected
  std::size_t onset = 0;      ///< last sample before the event, or before its detection if `slow`
  std::size_t last = 0;       ///< last sample before the last switching, or `onset`
  double theta_level = 0;     ///< median of the angle before the event, as written [rad]
  double first_angle = 0;     ///< angle of the first sample, as written [rad]
  double angle_rate = 0;      ///< median rate of the angle before the event [rad/s]
  double fast_angle = 0;      ///< 70 % quantile of the magnitude of the angle's rate, as written [rad/s]
  bool wraps_of_360 = false;  ///< the angle, as written in "rad", steps by about 360
  /// Ratio of the angle's rate to the deviation of frequency or speed: 1 if consistent, 0 if unknown.
  double angle_per_frequency = 0;
  std::size_t longest_repeat = 0;  ///< longest run of samples that equal the previous one in V, theta, P, Q
  std::size_t repeat_start = 0;    ///< first sample of this run
};

/// Returns the statistics of a record with at least kMinSamples finite samples.
Signals record_signals(const record::Record& record);

/// Returns the upper median of the values; 0 if there are none.
double median_of(std::vector<double> values);

}  // namespace swingbank::validate::check
