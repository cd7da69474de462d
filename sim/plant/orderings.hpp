#pragma once
// Which parameters of a machine are larger than which, by what they are: Xd > X'd > X''d > Xl, T'do > T''do.
#include <string>
#include <vector>

#include "sim/plant/plant.hpp"

namespace swingbank::sim::plant {

/// Parameters of a block's effect, by number.
struct Ordering {
  int greater = 0, smaller = 0;
  /// Whether a model may be believed against it: how a subtransient reactance is split at the leakage is not
  /// seen from outside, the equations hold either way, and public cases have machines with X''d below Xl.
  bool may_be_meant = false;
};

/// The orderings that a block's values are held to; where one of a pair is zero, it stands for "none" and
/// there is nothing to hold. Effect::unphysical says the same as one sentence.
std::vector<Ordering> orderings(const Block& block);
/// Those that the values violate.
std::vector<Ordering> violated(const Block& block);
/// "Xd = 0.147 pu is not above X'd = 1.53 pu".
std::string violation_text(const Block& block, const Ordering& ordering);

}  // namespace swingbank::sim::plant
