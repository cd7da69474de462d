#pragma once
// How large the noise is, from the whole records instead of the quiet stretch before the event alone: a
// verdict on a few per cent of chi2 needs it to a few per cent.
#include <array>

#include "validate/fit/fit.hpp"

namespace swingbank::validate::fit {

/// The events' noise with every channel's scaled to what the residual of `fit` shows from sample to sample.
/// The measure is the median of the squared second differences, which neither a slow misfit nor the moments
/// around a switching move. It supposes white noise, so the noise stays that of the pre-event stretch where
/// the residual before the events is not white.
event::NoiseModel sharpen_noise(const Fit& fit, const event::WhitenedEvents& events);

/// Noise of the played-in voltage, white where it was measured. An angle that was integrated from a frequency
/// goes astray from sample to sample instead.
struct VoltageNoise {
  /// Of V (relative), of theta [rad^2], and of what an integrated theta goes astray by in one sample [rad^2].
  Eigen::Vector3d variance = Eigen::Vector3d::Zero();
  /// Share of this noise that the measured P and Q carry too: 1 where an instrument makes them of the phasors
  /// that it records, 0 where each channel has noise of its own.
  double carried = 0;
  /// Share of the pre-event movement of V and theta that is the instrument's. It is 1 if the measured P and Q
  /// do not answer the movement, and 0 if they do as the model says, because the plant has then really seen
  /// it.
  double share = 0;
  Eigen::Vector3d doubt = Eigen::Vector3d::Zero();  ///< standard deviation of each variance, relative
  /// Share of a channel's variance that is its own noise and no answer to that of the voltage, by
  /// playin::Output; a hundredth is supposed at least.
  std::array<double, playin::kOutputs> own{};
  /// What P and Q of this operating point move by with V (relative) and theta [rad] where the current stands
  /// still, times `carried`: [channel][V, theta], in the channels' units.
  [[nodiscard]] Eigen::MatrixXd into(const event::FitEvent& event) const;
  /// The variances, less those that this event has not.
  [[nodiscard]] Eigen::Vector3d of(const event::FitEvent& event) const;
};

/// Noise of the played-in voltage as the plant answers it. The states are the plant's, less what the latest
/// sample did to them, and the mean error of V and theta over the pre-event window, from which everything is
/// counted. `event` gives the whitening, the channels and the start.
event::SlowNoise slow_noise(const playin::LinearPlant& plant, event::WhitenedEvent event,
                            const VoltageNoise& voltage);

/// The memory of an event's noise by slow_noise() about its start; none where slow noise hardly matters.
std::shared_ptr<const event::Innovations> memory_of(const sim::plant::PlantUnderTest& tested,
                                                    event::WhitenedEvent event, const VoltageNoise& voltage);

/// Measures it by what moves: at 3 to 10 Hz, because below this band the grid itself moves, and above it
/// instruments filter; before the events, and wherever the record moves no more than there.
VoltageNoise voltage_noise(const Fit& fit, const event::WhitenedEvents& events);

/// So many seconds at the operating point of `like` [s]. Answers are compared with zero.
event::FitEvent at_rest(const event::FitEvent& like, double seconds);

/// A minute at the operating point of `like`, with V and theta moved by noise of these variances
/// (VoltageNoise). Answers are compared with zero.
event::FitEvent minute_of_noise(const event::FitEvent& like, const Eigen::Vector3d& variance);

/// Noise of the played-in voltage passes exciter and rotor, and what comes out is slow. This follows it
/// through the plant's equations about each event's start, and returns the events' noise with that memory
/// where it matters.
event::NoiseModel remember_noise(const Fit& fit, const sim::Conventions& conventions,
                                 const event::WhitenedEvents& events);

/// Measures the events' noise anew through a fit of whatever structure: its variance where the fit is close,
/// its size from sample to sample, and its memory. Costs measured in it cannot be held against earlier ones.
event::NoiseModel measure_noise_through(const Fit& fit, const sim::Conventions& conventions,
                                        const event::WhitenedEvents& events);

/// How far the power of slow means of the residual (over 0.5, 1 and 2 s) lies above that of white noise, in
/// standard deviations, for the channel and length where it is largest.
double slow_remainder(const Fit& fit, const event::WhitenedEvents& events);

}  // namespace swingbank::validate::fit
