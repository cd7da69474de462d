#pragma once
// Whether a machine's data look like those of a machine, on the base that is said to be theirs.
#include <optional>
#include <string>

#include "sim/plant/plant.hpp"

namespace swingbank::validate::plant {

/// Data on another base than the machine's own, as the parts of a sentence.
struct ForeignBase {
  std::string what;  ///< "H = 500 s and Xd = 0.02 pu"
  std::string why, remedy;
};
/// Whether a machine's inertia and reactance together are those of a machine of another size than `base_mva`:
/// H on a base that is too small is as many times too large as Xd is too small. Where one of its values is
/// unusual in itself, a smaller ratio is told.
std::optional<ForeignBase> foreign_base(const sim::plant::Block& machine, double base_mva);

}  // namespace swingbank::validate::plant
