#pragma once
// Simulation of eight plants in a SIMD batch with one played-in voltage. The plants differ in values only.
// A search over many starts thus needs one run for eight plants.
#include <optional>
#include <span>
#include <vector>

#include "validate/playin/plant_playback.hpp"

namespace swingbank::validate::playin {

/// Returns the response of each run as simulate_playback() does, without sensitivities; an entry is empty
/// where simulate_playback() would throw. The runs share one record and one curve, and their plants have the
/// same effects. Eight runs take common steps, as short as the most demanding one requires. Responses
/// therefore differ from those of simulate_playback() within the tolerance.
std::vector<std::optional<Response>> simulate_playback_batch(std::span<const PlaybackRun> runs);

}  // namespace swingbank::validate::playin
