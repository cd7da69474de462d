#pragma once
// Noise of the played-in voltage, estimated from the whole records.
#include <array>
#include <vector>

#include "validate/noise/event_fit.hpp"

namespace swingbank::validate::noise {

/// Noise of the played-in voltage, white in each measured channel. An angle that was integrated from the
/// frequency has a random walk instead.
struct VoltageNoise {
  /// Variances of V (relative), of theta [rad^2], and of the random walk of an integrated theta [rad^2 per
  /// sample].
  Eigen::Vector3d variance = Eigen::Vector3d::Zero();
  /// Share of this noise that the measured P and Q also contain. 1: the instrument computes P and Q from the
  /// recorded phasors; 0: each channel has independent noise.
  double carried = 0;
  /// Share of the pre-event fluctuation of V and theta that is noise of their instruments. 1: the measured P
  /// and Q do not respond to the fluctuation; 0: they respond as the model does, so the fluctuation is real.
  double share = 0;
  Eigen::Vector3d doubt = Eigen::Vector3d::Zero();  ///< relative standard deviation of each variance
  /// Fraction of each channel's variance that is its own noise, by playin::Output. The rest is the response
  /// to the noise of the voltage. slow_noise() applies a lower limit of 0.01.
  std::array<double, playin::kOutputs> own{};
  /// Returns the sensitivity of the measured P and Q to V (relative) and theta [rad] at constant current,
  /// times `carried`: [channel][V, theta], in the channels' units.
  [[nodiscard]] Eigen::MatrixXd into(const event::FitEvent& event) const;
  /// Returns the variances that apply to this event's kind of angle; the others are 0.
  [[nodiscard]] Eigen::Vector3d of(const event::FitEvent& event) const;
};

/// Estimates the noise of the voltage from its fluctuation between 3 and 10 Hz. It uses the segments before
/// the events, and later segments that do not fluctuate more than these. Below this band the grid voltage
/// itself varies; above it, instruments filter.
VoltageNoise voltage_noise(const std::vector<EventFit>& fits, const WhitenedEvents& events);

}  // namespace swingbank::validate::noise
