#pragma once
// Short gaps of a record: how long they are, and what stands in them.
#include "validate/record/detail/times.hpp"

namespace swingbank::validate::record {

/// Cuts lost samples off both ends of the grid and says in about.notes what is missing. False where a gap is
/// longer than kLongestGap.
bool gaps_are_short(EvenRows& rows, Record& about);

/// Fills samples marked in record.lost: voltage, angle, frequency, speed, P and Q by what the samples on both
/// sides tell, or held there (the voltage) where it jumps within the gap; other channels go straight.
void bridge(Record& record);

}  // namespace swingbank::validate::record
