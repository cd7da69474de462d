#pragma once
// Candidates that depend on time: steps, pulses, ramps, decays and oscillations that start at a time of the
// record or at a delay after a voltage deviation.
#include "validate/user_model_search/regression.hpp"

namespace swingbank::validate::user_model_search {

/// Returns the best candidate of each shape and clock (time origin; output in pu or in proportion to the
/// initial value). `level`: see trigger_level(); 0: no candidates are triggered by the voltage.
std::vector<UserModelCandidate> timed_candidates(fit::InputKind kind, const UserModelRegression& regression,
                                                 double level);

}  // namespace swingbank::validate::user_model_search
