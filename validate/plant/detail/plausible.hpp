#pragma once
// Whether a machine's data look like those of a machine, on the base that is said to be theirs.
#include <optional>
#include <string>
#include <vector>

#include "sim/plant/plant.hpp"

namespace swingbank::validate::plant {

/// Data on another base than the machine's own.
struct ForeignBase {
  std::string what;  ///< "H = 500 s and Xd = 0.02 pu"
  double mva = 0;    ///< about the machine's own [MVA], two digits
  double ratio = 1;  ///< of it to the base of the data
};
/// Whether inertia and reactance together are those of a machine of another size: H on a base that is too
/// small is as many times too large as Xd is too small. `reactance`: "Xd" or "Xdp", whichever the effect has.
/// Where the data are not `sound` anyway, a smaller ratio is told.
std::optional<ForeignBase> foreign_base(const std::string& reactance, double h, double x, double base_mva,
                                        bool sound);

/// Values of a PSS/E file that stand for "no limit" (999, -9999) and lie beyond what is physically possible,
/// brought to the bound; what was done, for the person.
std::vector<std::string> settle_unlimited(sim::plant::Block& block);

}  // namespace swingbank::validate::plant
