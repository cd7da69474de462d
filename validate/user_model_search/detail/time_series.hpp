#pragma once
// Output of a user-defined model along the events, computed by its effect with the equations of a simulation.
#include "validate/user_model_search/regression.hpp"

namespace swingbank::validate::user_model_search {

/// Returns the output at every sample of the traces [event][sample] [pu]. The states are integrated by the
/// fourth-order Runge-Kutta method from sample to sample.
TimeSeries user_model_time_series(const sim::Effect& effect, const std::vector<double>& parameters,
                                  fit::InputKind kind, const std::vector<UserModelTrace>& traces);

}  // namespace swingbank::validate::user_model_search
