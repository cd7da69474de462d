#pragma once
// Interpolation of short gaps in a record.
#include "validate/record/detail/times.hpp"

namespace swingbank::validate::record {

/// Removes lost samples at both ends of the grid and notes the remaining gaps in about.notes. Returns false
/// if a gap is longer than kLongestGap.
bool gaps_are_short(EvenRows& rows, Record& about);

/// Fills the samples marked in record.lost. Voltage, angle, frequency, speed, P and Q are interpolated by a
/// polynomial, if enough samples surround the gap. If the voltage has a step in the gap, voltage and angle
/// take the nearest recorded value. In all other cases, and for all other channels, interpolation is linear.
void bridge(Record& record);

}  // namespace swingbank::validate::record
