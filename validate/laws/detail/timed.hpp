#pragma once
// Laws that follow the clock: steps, pulses, ramps, decays and oscillations that begin at a time of the
// record, or some time after the voltage has moved.
#include "validate/laws/regression.hpp"

namespace swingbank::validate::laws {

/// The best of each shape and clock; `level` as from trigger_level, 0: none is triggered by the voltage.
std::vector<LawCandidate> timed_candidates(fit::InputKind kind, const LawRegression& regression,
                                           double level);

}  // namespace swingbank::validate::laws
