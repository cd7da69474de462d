#pragma once
// Frames of a file that are no measurements: rows that repeat earlier ones, and frames of zeros.
#include "validate/record/detail/build.hpp"

namespace swingbank::validate::record {

/// Whether two rows hold the same values, apart from the time.
bool same_rows(const RawRecord& raw, std::size_t a, std::size_t b);

/// Removes rows that go back in time and repeat times and values of earlier rows, as archives that overlap
/// leave them. They are noted.
void drop_repeats(RawRecord& raw, SampleFaults& faults);

/// Frames in which voltage, power, current and their angles are all exactly zero are lost frames, if V, P and
/// Q go on behind them as before: a bolted fault at the terminals, which a simulation may write as zeros,
/// leaves the machine with another voltage and power. Frames at either end are lost, too. Both readings are
/// noted.
void lose_zero_frames(RawRecord& raw, SampleFaults& faults);

}  // namespace swingbank::validate::record
