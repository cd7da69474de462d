#pragma once
// What checks of a record need of its channels: levels, noise, where the event is, how steady it was before.
#include <cstddef>
#include <vector>

#include "validate/record/record.hpp"

namespace swingbank::validate::check {

/// One channel, in the record's units.
struct SignalFacts {
  double level = 0;        ///< median before the event (of the whole record where there is none)
  double white = 0;        ///< standard deviation of noise that changes from sample to sample
  double quietest = 0;     ///< spread of the quietest second
  double noise = 0;        ///< the larger of both
  double reach = 0;        ///< largest distance from the level
  double drift = 0;        ///< of a straight line through the samples before the event, over their length
  double drift_error = 0;  ///< its standard error
  double swing = 0;        ///< standard deviation about that line
};

struct Signals {
  SignalFacts V, P, Q;
  bool event = false;         ///< something leaves the noise
  bool slow = false;          ///< without a jump; it began before `onset`
  std::size_t onset = 0;      ///< last sample before the event
  std::size_t last = 0;       ///< last sample before the last switching, or `onset`
  double theta_level = 0;     ///< median of the angle before the event, as written [rad]
  double first_angle = 0;     ///< as written [rad]
  double angle_rate = 0;      ///< median slope of the angle before the event [rad/s]
  double fast_angle = 0;      ///< slope of the angle, as written, that 30 % of the samples exceed [rad/s]
  bool wraps_of_360 = false;  ///< the angle, as written in "rad", jumps by about 360
  double angle_per_frequency =
      0;  ///< slope of the angle over that of the frequency or speed; 1 if sound, 0 unknown
  std::size_t longest_hold = 0,
              hold_at = 0;  ///< samples that repeat the one before, in all of V, theta, P, Q
};

/// Of a record with at least kMinSamples finite samples.
Signals record_signals(const record::Record& record);

double median_of(std::vector<double> values);

}  // namespace swingbank::validate::check
