#pragma once
// Plausibility of a record's power: its units, its base, and the unit that it belongs to.
#include <optional>
#include <string>
#include <vector>

#include "base/complex.hpp"
#include "validate/check/check.hpp"

namespace swingbank::validate::check {

/// Returns whether x differs from target by at most the given fraction.
bool near(double x, double target, double share);

/// Common error of scale in P and Q, with its remedy.
struct BaseSlip {
  double factor;  ///< true value = value * factor
  std::string why, remedy;
};
std::vector<BaseSlip> base_slips(const record::Record& record, const PlantFacts& plant);

struct Doubt {
  std::string what, why, remedy;
};
/// Returns why P + jQ before the event [pu on the record's base] exceeds the capability of the machine; none
/// if it does not.
std::optional<Doubt> base_doubt(const record::Record& record, const PlantFacts& plant, Complex power);
/// Returns the ratio to the unit's output in its case, with a possible cause, if it differs by more than
/// usual redispatch explains.
std::optional<Doubt> dispatch_doubt(const record::Record& record, const PlantFacts& plant, Complex power);

}  // namespace swingbank::validate::check
