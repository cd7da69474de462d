#pragma once
// What a law puts out along the events, by the effect itself: the same equations as in any run.
#include "validate/laws/regression.hpp"

namespace swingbank::validate::laws {

/// At every sample of the traces [event][sample] [pu]: the effect's states are integrated by Runge-Kutta's
/// fourth order from sample to sample.
Course law_course(const sim::Effect& effect, const std::vector<double>& parameters, fit::InputKind kind,
                  const std::vector<LawTrace>& traces);

}  // namespace swingbank::validate::laws
