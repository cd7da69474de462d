#pragma once
// Noise level of the channels and of the played-in voltage, estimated from the whole records instead of the
// pre-event segment alone. An adequacy verdict resolves a few per cent of chi2, so the noise must be accurate
// to a few per cent.
#include <array>

#include "validate/fit/fit.hpp"

namespace swingbank::validate::fit {

/// Returns the events' noise with each channel scaled to the sample-to-sample noise of the residual of `fit`.
/// The estimator is the median of the squared second differences, which is insensitive to slow model error
/// and to samples near a switching. It assumes white noise: a channel whose pre-event residual is not white
/// keeps its noise.
event::NoiseModel sharpen_noise(const Fit& fit, const event::WhitenedEvents& events);

/// Noise of the played-in voltage, white in each measured channel. An angle that was integrated from the
/// frequency has a random walk instead.
struct VoltageNoise {
  /// Variances of V (relative), of theta [rad^2], and of the random walk of an integrated theta [rad^2 per
  /// sample].
  Eigen::Vector3d variance = Eigen::Vector3d::Zero();
  /// Share of this noise that the measured P and Q also carry. 1: the instrument computes P and Q from the
  /// recorded phasors; 0: each channel has independent noise.
  double carried = 0;
  /// Share of the pre-event fluctuation of V and theta that is instrument noise. 1: the measured P and Q do
  /// not respond to the fluctuation; 0: they respond as the model does, so the fluctuation is real.
  double share = 0;
  Eigen::Vector3d doubt = Eigen::Vector3d::Zero();  ///< relative standard deviation of each variance
  /// Share of each channel's variance that is its own noise and no response to the voltage's noise, by
  /// playin::Output. slow_noise() applies a lower limit of 0.01.
  std::array<double, playin::kOutputs> own{};
  /// Returns the sensitivity of the measured P and Q to V (relative) and theta [rad] at constant current,
  /// times `carried`: [channel][V, theta], in the channels' units.
  [[nodiscard]] Eigen::MatrixXd into(const event::FitEvent& event) const;
  /// Returns the variances that apply to this event's kind of angle; the others are 0.
  [[nodiscard]] Eigen::Vector3d of(const event::FitEvent& event) const;
};

/// Returns the state-space model of the voltage's noise behind the plant. Its states are those of the plant,
/// without the effect of the latest sample, and the mean error of V and theta before the event. All
/// deviations refer to that mean. `event` supplies whitening, channels and start.
event::SlowNoise slow_noise(const playin::LinearPlant& plant, event::WhitenedEvent event,
                            const VoltageNoise& voltage);

/// Returns the innovations filter of an event's noise, from slow_noise() about its start; null if slow noise
/// is negligible.
std::shared_ptr<const event::Innovations> memory_of(const sim::plant::PlantUnderTest& tested,
                                                    event::WhitenedEvent event, const VoltageNoise& voltage);

/// Estimates the voltage's noise from its fluctuation between 3 and 10 Hz, before the events and in later
/// segments that fluctuate no more. Below this band the grid itself moves; above it instruments filter.
VoltageNoise voltage_noise(const Fit& fit, const event::WhitenedEvents& events);

/// Returns an event of `seconds` [s] at the operating point of `like`, with zeros as measured channels.
event::FitEvent at_rest(const event::FitEvent& like, double seconds);

/// Returns an event of one minute at the operating point of `like`. V and theta have noise of these variances
/// (VoltageNoise); measured channels are zero.
event::FitEvent minute_of_noise(const event::FitEvent& like, const Eigen::Vector3d& variance);

/// Returns the events' noise with the innovations filter of the voltage's noise if it matters. The noise
/// of the played-in voltage passes through exciter and rotor and becomes slow; the filter follows it through
/// the plant's equations, linearised about each event's start.
event::NoiseModel remember_noise(const Fit& fit, const sim::Conventions& conventions,
                                 const event::WhitenedEvents& events);

/// Measures the events' noise anew through a fit of any structure: its variance if the fit is close, its
/// sample-to-sample level, and its innovations filter. Costs in the new noise are not comparable with earlier
/// ones.
event::NoiseModel measure_noise_through(const Fit& fit, const sim::Conventions& conventions,
                                        const event::WhitenedEvents& events);

/// Returns the largest excess of the residual's slow power over that of white noise [standard deviations].
/// The power is that of means over 0.5, 1 and 2 s, for each channel.
double slow_remainder(const Fit& fit, const event::WhitenedEvents& events);

}  // namespace swingbank::validate::fit
