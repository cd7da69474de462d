#pragma once
// Plausibility of a machine's data on their stated base.
#include <optional>
#include <string>

#include "sim/plant/plant.hpp"

namespace swingbank::validate::plant {

/// Data on a base other than the machine's own, as parts of a message.
struct ForeignBase {
  std::string what;  ///< "H = 500 s and Xd = 0.02 pu"
  std::string why, remedy;
};
/// Returns a finding if inertia and reactance together indicate a machine rating other than `base_mva`; empty
/// if not. On a base that is too small, H is too large and Xd is too small by the same factor. If one of the
/// machine's values is unusual by itself, a smaller factor suffices.
std::optional<ForeignBase> foreign_base(const sim::plant::Block& machine, double base_mva);

}  // namespace swingbank::validate::plant
