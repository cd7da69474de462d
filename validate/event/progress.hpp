#pragma once
// Progress of long analyses: the current phase and its completed share.
#include <functional>
#include <string>
#include <string_view>

namespace swingbank::validate::event {

/// Phase of a command, for progress messages.
enum class Phase {
  playing,  ///< playback of events for the report
  // phases of calibrate and add
  model_as_it_is,   ///< each event with the original model
  parameter_sets,   ///< screening of drawn parameter sets
  starts,           ///< fits from the best parameter sets
  voltage_noise,    ///< correction for the noise of the played-in voltage
  fitted_model,     ///< each event with the fitted model
  sensitivities,    ///< identifiability of the parameters
  effect_left_out,  ///< each event without the effect
  effect_added,     ///< each event with the effect
  // phases of the sparse parameter selection
  every_parameter,    ///< fit of all parameters
  parameter_subsets,  ///< fits of growing sets
  subsets_less_one,   ///< fits of the chosen set without each of its parameters in turn
  // phases of diagnose, some of them also of add
  base,           ///< fit of the base model
  missing_input,  ///< inference of torque and field voltage
  screening,      ///< screening of the hypotheses
  quick_fits,     ///< short fits
  full_fits,      ///< fits to convergence
  noise_again,    ///< refits after a new estimate of the noise
  unseen_events,  ///< hold-out tests
  user_models,    ///< user-defined models
  // phases of diagnose for a second effect in addition to the best one
  second_screening,    ///< screening
  second_quick_fits,   ///< short fits
  second_full_fits,    ///< fits to convergence
  pair_exchanges,      ///< pairs with another first effect
  pair_crossings,      ///< pairs of effects from two pairs
  pair_unseen_events,  ///< hold-out tests
};

/// Returns the name of a phase for messages.
std::string_view phase_words(Phase phase);

/// Callback with the phase, the current item (may be empty), and the numbers of completed and of all items.
/// The function may be empty.
using Progress = std::function<void(Phase phase, const std::string& item, int done, int total)>;

}  // namespace swingbank::validate::event
