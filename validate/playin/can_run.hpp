#pragma once
// Validity of a plant's parameters according to the checks of its effects.
#include "sim/plant/plant.hpp"

namespace swingbank::validate::playin {

/// Returns whether the block's equations are defined for its parameters.
bool can_run(const sim::plant::Block& block);
/// Returns whether this holds for all blocks of a plant, including its instruments.
bool can_run(const sim::plant::Plant& plant);
/// Returns whether the plant can run and its parameters are physically possible (Effect::unphysical). A
/// violation is allowed if `given` (the submitted model with the same blocks) already contains it, so that a
/// search may return to the submitted values.
bool can_exist_beside(const sim::plant::Plant& plant, const sim::plant::Plant& given);

}  // namespace swingbank::validate::playin
