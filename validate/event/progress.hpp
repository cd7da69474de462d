#pragma once
// Progress of analyses that take minutes: the phase at work, and how much of it is done.
#include <functional>
#include <string>

namespace swingbank::validate::event {

enum class Phase {
  playing,  ///< events are played for the page
  // calibrate, and add
  model_as_it_is,   ///< each event with the model as it is
  parameter_sets,   ///< drawn sets are screened
  starts,           ///< the best of them are fitted
  voltage_noise,    ///< the noise of the played-in voltage is corrected
  fitted_model,     ///< each event with the fitted model
  sensitivities,    ///< what the records determine
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

/// Called with the phase, what of it is at work (may be empty), and how many of how many are done. May be
/// empty.
using Progress = std::function<void(Phase phase, const std::string& item, int done, int total)>;

}  // namespace swingbank::validate::event
