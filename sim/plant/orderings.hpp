#pragma once
// Physical orderings of machine parameters: Xd > X'd > X''d > Xl, T'do > T''do, likewise in the q axis, and
// S1.2 > S1.0.
#include <string>
#include <vector>

#include "sim/plant/plant.hpp"

namespace swingbank::sim::plant {

/// An ordering of two parameters, by index in a block's effect.
struct Ordering {
  int greater = 0, smaller = 0;  ///< indices of the two parameters in the effect
  /// Whether a model may violate it: true for X''d, X''q > Xl. The leakage part of a subtransient reactance
  /// is not observable at the terminal, the equations hold either way, and public cases have machines with
  /// X''d below Xl.
  bool may_be_meant = false;
};

/// Returns the orderings that apply to a block's values. A parameter of zero means "none" and has no
/// ordering. Effect::unphysical checks the same orderings.
std::vector<Ordering> orderings(const Block& block);
/// Returns the orderings that the values violate.
std::vector<Ordering> violated(const Block& block);
/// Returns "Xd = 0.147 pu is not above X'd = 1.53 pu".
std::string violation_text(const Block& block, const Ordering& ordering);

}  // namespace swingbank::sim::plant
