#pragma once
// Variants: effects that differ from another effect in details that a record hardly shows. A header declares
// a variant with `variant_of`, the name of the other effect. The search for a missing effect then tries only
// the other effect.
#include "sim/core/effect.hpp"

namespace swingbank::sim::library {

/// Returns the compiled effect of which `effect` is a variant, or nullptr.
const Effect* variant_of(const Effect& effect);

}  // namespace swingbank::sim::library
