#pragma once
// Plausibility of a record's P and Q: physical units, MVA base, signs, and generating unit.
#include <optional>
#include <string>
#include <vector>

#include "base/complex.hpp"
#include "validate/check/check.hpp"
#include "validate/switching/step_intervals.hpp"

namespace swingbank::validate::check {

/// Returns whether x differs from target by at most the fraction `share` of target.
bool near(double x, double target, double share);

/// Common error in the scale of P and Q, with its remedy.
struct BaseSlip {
  double factor;  ///< true value = value * factor
  std::string why, remedy;
};
std::vector<BaseSlip> base_slips(const record::Record& record, const PlantFacts& plant);

/// Message about doubtful values of a record.
struct Doubt {
  std::string what, why, remedy;
};
/// Returns a doubt if P + jQ before the event [pu on the record's base] exceeds the capability of the
/// machine.
std::optional<Doubt> base_doubt(const record::Record& record, const PlantFacts& plant, Complex power);
/// Returns a doubt, with a possible cause, if P + jQ before the event [pu on the record's base] differs from
/// the unit's output in its power-flow case by more than a usual redispatch.
std::optional<Doubt> dispatch_doubt(const record::Record& record, const PlantFacts& plant, Complex power);

/// Returns a doubt if a few frames have a voltage or current that cannot occur at a plant. A wrong unit or
/// base affects all frames and causes none.
std::optional<Doubt> frame_doubt(const record::Record& record, const PlantFacts& plant);

/// Returns a doubt if the signs of P and Q of a synchronous machine seem reversed, or P and Q exchanged. Uses
/// `P` before the event and the steps of |V| and Q, but no angle. `noise`: standard deviation of the noise of
/// Q. `P` and `noise` are in pu on the record's base.
std::optional<Doubt> sign_doubt(const record::Record& record, const PlantFacts& plant, double P,
                                const std::vector<switching::StepInterval>& steps, double noise);

}  // namespace swingbank::validate::check
