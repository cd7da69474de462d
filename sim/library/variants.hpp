#pragma once
// Which effects are variants of another: they differ from it by details that a record hardly shows. A header
// says so with `variant_of`, the other's name; a search that tries every effect then tries that one alone.
#include "sim/core/effect.hpp"

namespace swingbank::sim::library {

/// The compiled effect that this one is a variant of, or nullptr.
const Effect* variant_of(const Effect& effect);

}  // namespace swingbank::sim::library
