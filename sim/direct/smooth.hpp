#pragma once
// Smoothing of a noisy record, for methods that assume exact signals.
#include "sim/core/recording.hpp"

namespace swingbank::sim::direct {

/// Returns the record with every signal smoothed by local parabolas over 0.2 s. No parabola crosses a voltage
/// step. Before the event, each signal is replaced by its mean.
Recording smoothed(Recording record);

}  // namespace swingbank::sim::direct
