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

/// How coloured the residual is by nature: the played-in voltage's own noise passes exciter and rotor, and
/// what comes out is slow. Power of the whitened answer's slow part (means over two seconds) in the channel
/// that has most, in units of white noise. Evidence and what a free input explains of noise grow by as much.
double noise_colour(const sim::Plant& plant, const sim::Conventions& conventions,
                    const std::vector<FitEvent>& events);

}  // namespace swingbank::validate
