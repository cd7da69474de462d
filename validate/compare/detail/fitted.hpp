#pragma once
// Playback of a record with fitted switching times and initial state. A record does not determine when
// between two samples the network switched, and a few milliseconds change the rotor swing.
#include "validate/compare/compare.hpp"
#include "validate/noise/whitened_events.hpp"

namespace swingbank::validate::compare {

/// Noise model and initial state of the fit. Voltage noise passes through the plant: with an integrating
/// regulator it moves P and Q by many times their own noise. If this response were treated as white noise, it
/// would bias the switching times.
enum class Fitted {
  in_white_noise,  ///< the noise of P and Q is white
  in_slow_noise,   ///< the noise of P and Q includes the plant's response to voltage noise
  steady_start     ///< the initial state is the steady state before the event; noise is white
};

/// Fits switching times and initial state of an event whose record is set, with the model unchanged. `events`
/// contains this record, prepared for fitting; `step_shape` is the shape of its steps. Sets switchings,
/// playback and left_out, and the angle and notes of the record. Samples within a filtered step are not
/// played in. Throws InputError if the simulation fails.
void play_fitted(const plant::PlantModel& model, const noise::WhitenedEvents& events,
                 switching::StepShape step_shape, Fitted how, EventComparison& e);

/// Sets EventComparison::doubt of an event whose voltage was played in.
void add_doubt(const plant::PlantModel& model, EventComparison& e);

}  // namespace swingbank::validate::compare
