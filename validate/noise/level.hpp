#pragma once
// Noise level of the channels, estimated from the residuals of fits over the whole records instead of the
// pre-event segment alone. An adequacy verdict resolves a few per cent of chi2, so the noise must be accurate
// to a few per cent.
#include <vector>

#include "sim/plant/under_test.hpp"
#include "validate/noise/event_fit.hpp"

namespace swingbank::validate::noise {

/// Returns the events' noise, scaled for each channel to the sample-to-sample noise of the fit's residual.
/// The estimator is the median of the squared second differences, which is insensitive to slow model error
/// and to samples near a switching. It assumes white noise, so the noise of a channel whose pre-event
/// residual is not white remains unchanged.
NoiseModel sharpen_noise(const std::vector<EventFit>& fits, const WhitenedEvents& events);

/// Returns the events' noise with an innovations filter for the voltage noise, or without a filter if the
/// slow noise is negligible. Exciter and rotor low-pass filter the noise of the played-in voltage. The filter
/// models this low-pass filtering with the plant's equations, linearised about each event's start.
NoiseModel remember_noise(const sim::plant::PlantUnderTest& tested, const std::vector<EventFit>& fits,
                          const WhitenedEvents& events);

/// Estimates the events' noise again from fits of any structure: its pre-event variance if `reduced_chi2` [-]
/// is below thresholds::noise.measurable, its sample-to-sample level, and its innovations filter. Costs in
/// units of the new noise are not comparable with earlier ones.
NoiseModel measure_noise_through(const sim::plant::PlantUnderTest& tested, const std::vector<EventFit>& fits,
                                 double reduced_chi2, const WhitenedEvents& events);

/// Returns the largest excess of the residual's slow power over that of white noise [standard deviations].
/// The slow power of a channel is the power of its means over 0.5, 1 and 2 s.
double slow_remainder(const std::vector<EventFit>& fits, const WhitenedEvents& events);

}  // namespace swingbank::validate::noise
