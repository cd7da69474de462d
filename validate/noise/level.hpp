#pragma once
// Noise level of the channels through fits of the events, estimated from the whole records instead of the
// pre-event segment alone. An adequacy verdict resolves a few per cent of chi2, so the noise must be accurate
// to a few per cent.
#include <vector>

#include "sim/plant/under_test.hpp"
#include "validate/noise/event_fit.hpp"

namespace swingbank::validate::noise {

/// Returns the events' noise with each channel scaled to the sample-to-sample noise of the residual of its
/// fit. The estimator is the median of the squared second differences, which is insensitive to slow model
/// error and to samples near a switching. It assumes white noise: a channel whose pre-event residual is not
/// white keeps its noise.
NoiseModel sharpen_noise(const std::vector<EventFit>& fits, const WhitenedEvents& events);

/// Returns the events' noise with the innovations filter of the voltage's noise if it matters. The noise
/// of the played-in voltage passes through exciter and rotor and becomes slow; the filter follows it through
/// the plant's equations, linearised about each event's start.
NoiseModel remember_noise(const sim::plant::PlantUnderTest& tested, const std::vector<EventFit>& fits,
                          const WhitenedEvents& events);

/// Measures the events' noise anew through fits of any structure: its variance if they are close
/// (`reduced_chi2` [-]), its sample-to-sample level, and its innovations filter. Costs in the new noise are
/// not comparable with earlier ones.
NoiseModel measure_noise_through(const sim::plant::PlantUnderTest& tested, const std::vector<EventFit>& fits,
                                 double reduced_chi2, const WhitenedEvents& events);

/// Returns the largest excess of the residual's slow power over that of white noise [standard deviations].
/// The power is that of means over 0.5, 1 and 2 s, for each channel.
double slow_remainder(const std::vector<EventFit>& fits, const WhitenedEvents& events);

}  // namespace swingbank::validate::noise
