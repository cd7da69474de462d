#pragma once
// What the jumps of a record say about its columns. When the network switches, the current of a synchronous
// machine jumps by the voltage's jump behind its subtransient reactance, dV = -jX'' dI (Kundur, Power System
// Stability and Control, 3.6), whatever else the plant has: a record of which this is not true by far has its
// columns or bases confused.
#include <string>
#include <vector>

#include "validate/record/record.hpp"

namespace swingbank::validate::check {

/// A sample interval (or two, where a filter smears the jump) in which the voltage jumps.
struct Jump {
  std::size_t before, after;  ///< samples
};
/// Jumps of the voltage phasor, as small as can be told from noise and swings.
std::vector<Jump> find_jumps(const record::Record& record);
/// Those large enough to divide by: not what a small event makes, nor where a filter longer than a fault
/// turns from fall to rise.
std::vector<Jump> clear_jumps(const record::Record& record);

/// What the jumps say, from dV = -jX dI by least squares.
struct JumpFit {
  double reactance = 0;     ///< X [pu on the record's base], current out of the machine; X'' if all is well
  double reduced_chi2 = 1;  ///< share of sum |dV|^2 that this leaves: below 0.01 for sound records
  double voltage = 0, current = 0;  ///< mean |dV|^2 and |dI|^2 of a jump [pu^2]
};
/// P and Q are taken `delay` samples later than the voltage. NaN where there is nothing to divide by.
JumpFit fit_jumps(const record::Record& record, const std::vector<Jump>& jumps, int delay);

/// By how many samples P and Q jump later than the voltage; the same for every jump, otherwise 0.
int power_delay(const record::Record& record, const std::vector<Jump>& jumps);

}  // namespace swingbank::validate::check
