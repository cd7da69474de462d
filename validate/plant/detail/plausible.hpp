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
/// Returns a finding if inertia and reactance together indicate a machine of another size than `base_mva`: on
/// a base that is too small, H is too large by the same factor by which Xd is too small. If one of its values
/// is unusual by itself, a smaller ratio suffices.
std::optional<ForeignBase> foreign_base(const sim::plant::Block& machine, double base_mva);

}  // namespace swingbank::validate::plant
