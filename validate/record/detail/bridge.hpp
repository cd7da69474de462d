#pragma once
// Interpolation of short gaps in a record.
#include "validate/record/detail/times.hpp"

namespace swingbank::validate::record {

/// Removes lost samples at both ends of the grid and notes missing ones in about.notes. Returns false if a
/// gap is longer than kLongestGap.
bool gaps_are_short(EvenRows& rows, Record& about);

/// Fills samples marked in record.lost. Voltage, angle, frequency, speed, P and Q are interpolated from both
/// sides, or held (the voltage) if it steps within the gap; other channels are linear.
void bridge(Record& record);

}  // namespace swingbank::validate::record
