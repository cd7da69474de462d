#pragma once
// What an interrupted fit leaves: the best values until then.
#include "base/stop_signal.hpp"
#include "validate/fit/fit.hpp"

namespace swingbank::validate::fit {

/// Thrown by fit(), and by what is made of fits, where they were interrupted: `reached` holds plant,
/// parameters (without errors), chi2, belief and values of the best point, but no events.
struct InterruptedFit : Interrupted {
  Fit reached;
};

}  // namespace swingbank::validate::fit
