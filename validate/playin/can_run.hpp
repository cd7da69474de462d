#pragma once
// Can this plant run? What the checks of its effects say of the parameters it has.
#include "sim/plant/plant.hpp"

namespace swingbank::validate::playin {

/// Whether the block's equations can be run with its parameters.
bool can_run(const sim::plant::Block& block);
/// The same of every block of a plant, instruments included.
bool can_run(const sim::plant::Plant& plant);
/// Whether the plant can be run, and a machine, a control or an instrument of that kind can have such
/// parameters (Effect::unphysical). What the values of `given`, a plant of the same blocks, violate may be
/// violated: `given` is the model as submitted, so that a search which crossed such a limit can go back.
bool can_exist_beside(const sim::plant::Plant& plant, const sim::plant::Plant& given);

}  // namespace swingbank::validate::playin
