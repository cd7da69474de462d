#include "validate/event/progress.hpp"

namespace swingbank::validate::event {

std::string_view phase_words(Phase phase) {
  switch (phase) {
    case Phase::playing:
      return "playback of the events";
    case Phase::model_as_it_is:
      return "submitted model";
    case Phase::parameter_sets:
      return "screening of parameter sets";
    case Phase::starts:
      return "fit of the parameters";
    case Phase::voltage_noise:
      return "bias correction for voltage noise";
    case Phase::fitted_model:
      return "fitted model";
    case Phase::sensitivities:
      return "sensitivities to the parameters";
    case Phase::effect_left_out:
      return "model without the effect";
    case Phase::effect_added:
      return "model with the effect";
    case Phase::every_parameter:
      return "fit of all parameters";
    case Phase::parameter_subsets:
      return "search for wrong parameters";
    case Phase::subsets_less_one:
      return "evidence of each wrong parameter";
    case Phase::base:
      return "refit of the model's parameters";
    case Phase::missing_input:
      return "inference of the missing input";
    case Phase::screening:
      return "screening of effects";
    case Phase::quick_fits:
      return "quick fits";
    case Phase::full_fits:
      return "full fits of the best candidates";
    case Phase::noise_again:
      return "second estimate of the noise";
    case Phase::unseen_events:
      return "hold-out tests of effects";
    case Phase::user_models:
      return "search for user-defined models";
    case Phase::second_screening:
      return "screening of second effects";
    case Phase::second_quick_fits:
      return "quick fits of second effects";
    case Phase::second_full_fits:
      return "full fits of the best second effects";
    case Phase::pair_exchanges:
      return "exchange of effects in pairs";
    case Phase::pair_crossings:
      return "exchange of partners between pairs";
    case Phase::pair_unseen_events:
      return "hold-out tests of pairs";
  }
  return "";
}

}  // namespace swingbank::validate::event
