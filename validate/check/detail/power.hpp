#pragma once
// Plausibility of a record's power: its units, its base, and the unit that it belongs to.
#include <optional>
#include <string>
#include <vector>

#include "base/complex.hpp"
#include "validate/check/check.hpp"
#include "validate/switching/step_intervals.hpp"

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

/// Returns why the signs of P and Q, or their order, are doubtful for a synchronous machine, from P before
/// the event [pu on the record's base] and the steps of |V| and Q; none if they are not. `noise`: standard
/// deviation of Q [pu on the record's base]. It needs no angle and no dispatch.
std::optional<Doubt> sign_doubt(const record::Record& record, const PlantFacts& plant, double P,
                                const std::vector<switching::StepInterval>& steps, double noise);

}  // namespace swingbank::validate::check
