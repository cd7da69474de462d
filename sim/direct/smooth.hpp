#pragma once
// A noisy record made smooth, for methods that take signals as exact.
#include "sim/core/recording.hpp"

namespace swingbank::sim::direct {

/// Every signal by local parabolas over 0.2 s, not across a leap of the voltage, and by its mean before the
/// event.
Recording smoothed(Recording record);

}  // namespace swingbank::sim::direct
