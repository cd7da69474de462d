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

/// Noise of the played-in voltage passes exciter and rotor, and what comes out is slow. Follows it through
/// the plant's equations about each event's start and gives the events' noise that memory, where it matters.
/// Density of the voltage's noise: what moves at 3 to 10 Hz before the events (below, the grid itself moves;
/// above, instruments filter), as far as the residual of `fit` says that the instrument made it.
void remember_noise(const Fit& fit, const sim::Conventions& conventions, std::vector<FitEvent>& events);

/// How far the power of slow means of the residual (0.5, 1 and 2 s) lies above that of white noise, in
/// standard deviations, in the channel and length where that is most.
double slow_remainder(const Fit& fit, const std::vector<FitEvent>& events);

}  // namespace swingbank::validate
