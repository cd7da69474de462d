#pragma once
// Eight plants driven at once by one voltage, in the lanes of a pack: they differ in values only, so that a
// search which looks at many starts pays for one run where it had eight.
#include <optional>
#include <span>
#include <vector>

#include "validate/playin/driven_plant.hpp"

namespace swingbank::validate::playin {

/// What drive() answers to each run, without slopes; nothing where it would throw. The runs have one record
/// and one curve, and plants of the same effects. Eight of them take common steps, as short as the worst of
/// them needs: answers differ from those of drive() by what the tolerance allows.
std::vector<std::optional<Response>> drive_together(std::span<const Drive> runs);

}  // namespace swingbank::validate::playin
