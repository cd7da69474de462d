#pragma once
// What the power of a record says about its units, its base and the unit it belongs to.
#include <optional>
#include <string>
#include <vector>

#include "base/complex.hpp"
#include "validate/check/check.hpp"

namespace swingbank::validate::check {

/// Whether x differs from target by at most a share of it.
bool near(double x, double target, double share);

/// A way in which P and Q have come to be wrong, and what to do about it.
struct BaseSlip {
  double factor;  ///< true value = value * factor
  std::string why, remedy;
};
std::vector<BaseSlip> base_slips(const record::Record& record, const PlantFacts& plant);

struct Doubt {
  std::string what, why, remedy;
};
/// Why P + jQ before the event [pu on the record's base] is beyond what the machine can give; none: it is
/// not.
std::optional<Doubt> base_doubt(const record::Record& record, const PlantFacts& plant, Complex power);
/// The ratio to what the unit delivers in its case, and what it may come of, where both differ by more than
/// units run apart. Dispatch changes from day to day.
std::optional<Doubt> dispatch_doubt(const record::Record& record, const PlantFacts& plant, Complex power);

}  // namespace swingbank::validate::check
