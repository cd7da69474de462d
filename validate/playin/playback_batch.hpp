#pragma once
// Simulation of eight plants in a SIMD batch with one played-in voltage. The plants differ in values only, so
// a search over many starts pays for one run instead of eight.
#include <optional>
#include <span>
#include <vector>

#include "validate/playin/plant_playback.hpp"

namespace swingbank::validate::playin {

/// Returns the responses of simulate_playback() to each run without sensitivities; an entry is empty where
/// simulate_playback() would throw. The runs share one record and one curve, and their plants have the same
/// effects. Eight of them take common steps, as short as the most demanding needs, so responses differ from
/// those of simulate_playback() within the tolerance.
std::vector<std::optional<Response>> simulate_playback_batch(std::span<const PlaybackRun> runs);

}  // namespace swingbank::validate::playin
