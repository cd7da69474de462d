#pragma once
// Fits of the live page: diagnosis, addition of an effect, and calibration. Each runs in a separate process
// and reports by messages.
#include <functional>

#include "validate/live/session.hpp"

namespace swingbank::validate::live {

/// Receives the messages of a fit, from any thread. Member "type":
/// - "progress": phase (event::Phase), item, done, total
/// - "preliminary": verdict in words so far, candidates with their probabilities, inferred inputs of each
/// event
/// - "reached": reduced chi-square (chi2) and curves (events) [pu] of a fit that is better than all earlier
/// ones
/// - "diagnosis": the result of a diagnosis
/// - "end": the end of a diagnosis
/// - "step": a new model, for step_of_fit()
/// - "failed": text
using Emit = std::function<void(const nlohmann::json& message)>;

/// Runs the fit of a request. Its members are "kind" (one of diagnose, add, calibrate), "plant"
/// (plant_json()), "effect" (of add) and "held_out". On a stop signal, a diagnosis sends its result so far;
/// any other fit sends a step with the values that it has reached, or "failed" if there are none.
void run_fit(const Setup& setup, const nlohmann::json& request, const Emit& emit);

/// Returns effects, values and conventions of a model's plant, exact to the last bit.
nlohmann::json plant_json(const plant::PlantModel& model);
/// Returns `model` with another plant of the same case. Throws InputError if an effect is unknown.
plant::PlantModel with_plant(plant::PlantModel model, const nlohmann::json& plant);
/// Returns the model step that a message of type "step" describes. The caller compares it with the records.
/// `from`: the step that was fitted; `parent`: its number.
Step step_of_fit(const Setup& setup, const Step& from, int parent, const nlohmann::json& message);

}  // namespace swingbank::validate::live
