#pragma once
// Effects of blind cases: the compiled effects and the unlisted disturbances. No library contains the
// unlisted disturbances, so that no hypothesis can name them.
#include <span>
#include <string>

#include "sim/grid/grid.hpp"

namespace swingbank::research::blind::cases {

/// Returns the unlisted disturbances.
std::span<const sim::Effect> unlisted_effects();
/// Returns the compiled effect or unlisted disturbance of that name; nullptr if there is none.
const sim::Effect* blind_effect(const std::string& name);
/// Reads "EFFECT[:PARAM=VALUE,...]". The other parameters have their default values.
sim::plant::Block blind_block(const std::string& text, const std::string& where, Problems& problems);

}  // namespace swingbank::research::blind::cases
