#pragma once
// Progress of long analyses: the current phase and its completed share.
#include <functional>
#include <string>

namespace swingbank::validate::event {

enum class Phase {
  playing,  ///< playback of events for the report
  // calibrate, and add
  model_as_it_is,   ///< each event with the original model
  parameter_sets,   ///< screening of drawn parameter sets
  starts,           ///< fits from the best of them
  voltage_noise,    ///< correction for the noise of the played-in voltage
  fitted_model,     ///< each event with the fitted model
  sensitivities,    ///< identifiability of the parameters
  effect_left_out,  ///< each event without the effect
  effect_added,     ///< each event with the effect
  // sparse parameter selection
  every_parameter,
  parameter_subsets,
  subsets_less_one,
  // diagnose, and add in part
  base,
  missing_input,
  screening,
  quick_fits,
  full_fits,
  noise_again,
  unseen_events,
  laws,
  // diagnose, with a second effect beside the best one
  second_screening,
  second_quick_fits,
  second_full_fits,
  pair_exchanges,
  pair_crossings,
  pair_unseen_events,
};

/// Callback with the phase, the current item (may be empty), and the numbers of completed and of all items.
/// May be empty.
using Progress = std::function<void(Phase phase, const std::string& item, int done, int total)>;

}  // namespace swingbank::validate::event
