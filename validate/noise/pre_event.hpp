#pragma once
// Noise of each channel, estimated from the residual before the events.
#include <vector>

#include "sim/plant/under_test.hpp"
#include "validate/event/event.hpp"
#include "validate/noise/whitened_events.hpp"

namespace swingbank::validate::noise {

/// Returns the prepared events (event::prepare_events) with their noise. The noise covariance is that of the
/// pre-event residual of `model`, pooled over the events. It thus includes the voltage noise transferred
/// through the machine's reactance, and the correlation of P and Q. The square of `switching::kLeastNoise` is
/// added to each variance; for speed, that of kLeastSpeedNoise. Throws InputError if a record has no
/// pre-event window.
WhitenedEvents whitened_events(const plant::PlantModel& model, std::vector<record::Record> records,
                               const event::FitEventOptions& options = {});

/// Returns prepared events with their noise, as whitened_events().
WhitenedEvents with_noise(const plant::PlantModel& model, std::vector<event::FitEvent> events);

/// Estimates the noise again with another model of the plant, as white noise. An error of 20 % in a reactance
/// causes an error of 20 % in the noise.
NoiseModel measure_noise(const sim::plant::PlantUnderTest& tested, const WhitenedEvents& events);

/// Noise floor of the speed [pu]: effect of an error of 1e-4 pu of P that lasts 0.1 s on a machine of H = 1
/// s.
constexpr double kLeastSpeedNoise = 5e-6;

}  // namespace swingbank::validate::noise
