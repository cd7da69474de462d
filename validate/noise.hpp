#pragma once
// How large the noise is, from the whole records instead of the quiet stretch before the event alone: a
// verdict on a few per cent of chi2 needs it to a few per cent.
#include "validate/fit.hpp"

namespace swingbank::validate {

/// Scales every channel's noise to what the residual of `fit` shows from sample to sample (second
/// differences, whose median neither a misfit, slow beside the sampling, nor the moments around a switching
/// move). Only where the residual before the events is white, as that measure supposes; elsewhere the noise
/// stays that of the pre-event stretch.
void sharpen_noise(const Fit& fit, std::vector<FitEvent>& events);

/// Noise of the played-in voltage, of these variances [V/V, rad], as the plant answers it: the states are the
/// plant's, less what the latest sample did to them, and the mean error of V and theta over the pre-event
/// window, from which everything is counted. `event`: whitening at once, channels, start.
SlowNoise slow_noise(const LinearPlant& plant, const FitEvent& event, const Eigen::Vector2d& variance);

/// The memory of an event's noise by slow_noise() about its start; none where that hardly matters.
std::shared_ptr<const Innovations> memory_of(const sim::Plant& plant, const sim::Conventions& conventions,
                                             const FitEvent& event, const Eigen::Vector2d& variance);

/// Noise of the played-in voltage, by what moves before the events.
struct VoltageNoise {
  /// Share of the pre-event movement of V and theta that is the instrument's: 1 if the measured P and Q do
  /// not answer it, 0 if they do as the model says, for then the plant has really seen it.
  double share = 0;
  /// Of white noise as dense as the instrument's share of what moves at 3 to 10 Hz (below, the grid itself
  /// moves; above, instruments filter) [V/V, rad].
  Eigen::Vector2d variance = Eigen::Vector2d::Zero();
};
VoltageNoise voltage_noise(const Fit& fit, const std::vector<FitEvent>& events);

/// A minute at the operating point of `like`, V and theta moved by that many standard deviations of noise;
/// answers are compared with zero.
FitEvent minute_of_noise(const FitEvent& like, const Eigen::Vector2d& deviation);

/// Noise of the played-in voltage passes exciter and rotor, and what comes out is slow. Follows it through
/// the plant's equations about each event's start and gives the events' noise that memory, where it matters.
void remember_noise(const Fit& fit, const sim::Conventions& conventions, std::vector<FitEvent>& events);

/// Misfit below which a structure's reactances are near enough to measure the noise with.
constexpr double kClose = 4;

/// Measures the events' noise anew through a fit of theirs, of whatever structure: its variance where the fit
/// is close, how large it is sample by sample, and its memory.
void measure_noise_through(const Fit& fit, const sim::Conventions& conventions,
                           std::vector<FitEvent>& events);

/// How far the power of slow means of the residual (0.5, 1 and 2 s) lies above that of white noise, in
/// standard deviations, in the channel and length where that is most.
double slow_remainder(const Fit& fit, const std::vector<FitEvent>& events);

}  // namespace swingbank::validate
