#pragma once
// Result of an interrupted fit: the best values so far.
#include "base/stop_signal.hpp"
#include "validate/fit/fit.hpp"

namespace swingbank::validate::fit {

/// Exception of fit(), and of functions that call it, on interruption. `reached` contains the plant, the
/// parameters (without errors), chi2, prior_cost and `values` of the best point; fit() adds no events.
struct InterruptedFit : Interrupted {
  Fit reached;  ///< best point so far
};

}  // namespace swingbank::validate::fit
