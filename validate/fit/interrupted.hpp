#pragma once
// Result of an interrupted fit: the best values so far.
#include "base/stop_signal.hpp"
#include "validate/fit/fit.hpp"

namespace swingbank::validate::fit {

/// Thrown by fit(), and by functions that call it, on interruption. `reached` holds plant, parameters
/// (without errors), chi2, belief and values of the best point, but no events.
struct InterruptedFit : Interrupted {
  Fit reached;  ///< best point so far
};

}  // namespace swingbank::validate::fit
