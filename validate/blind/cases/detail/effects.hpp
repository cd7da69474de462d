#pragma once
// Effects as blind cases name them: the compiled ones and the private set of odd drives, which no library
// holds, so that no hypothesis can name them.
#include <span>
#include <string>

#include "sim/grid/grid.hpp"

namespace swingbank::validate::blind::cases {

/// The private set.
std::span<const sim::Effect> odd_effects();
/// A compiled effect or one of the private set; nullptr if there is none of that name.
const sim::Effect* blind_effect(const std::string& name);
/// "EFFECT[:PARAM=VALUE,...]"; parameters not named keep the effect's standard value.
sim::plant::Block blind_block(const std::string& text, const std::string& where, Problems& problems);

}  // namespace swingbank::validate::blind::cases
