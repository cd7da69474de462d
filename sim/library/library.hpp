#pragma once
// Every effect the program knows: those compiled from sim/effects and those read from law files.
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/core/effect.hpp"

namespace swingbank::sim::library {

/// Every compiled effect, in the order of the file names. Generated: sim/effects/*.hpp.
std::span<const Effect> all_effects();
/// nullptr if there is none of that name (case matters not), compiled or added.
const Effect* find_effect(std::string_view name);
/// Adds an effect made at run time (a law file). Throws InputError if the name is taken.
const Effect& add_effect(Effect effect);
/// Every effect: compiled ones, then added ones.
std::vector<const Effect*> every_effect();
/// Names of all effects of a slot (of all slots) for error messages: "GENCLS, GENROU".
std::string effect_names();
std::string effect_names(Slot slot);

}  // namespace swingbank::sim::library
