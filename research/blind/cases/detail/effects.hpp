#pragma once
// Effects of blind cases: the compiled ones and the unlisted ones, which no library contains, so that no
// hypothesis can name them.
#include <span>
#include <string>

#include "sim/grid/grid.hpp"

namespace swingbank::research::blind::cases {

/// Unlisted effects.
std::span<const sim::Effect> unlisted_effects();
/// Returns the compiled or unlisted effect of that name; nullptr: none.
const sim::Effect* blind_effect(const std::string& name);
/// Reads "EFFECT[:PARAM=VALUE,...]"; parameters that are not named have their default values.
sim::plant::Block blind_block(const std::string& text, const std::string& where, Problems& problems);

}  // namespace swingbank::research::blind::cases
