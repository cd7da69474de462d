#pragma once
// Frames that are not measurements: rows that repeat earlier ones, and frames of zeros.
#include "validate/record/detail/build.hpp"

namespace swingbank::validate::record {

/// Returns whether two rows hold the same values, apart from the time.
bool same_rows(const RawRecord& raw, std::size_t a, std::size_t b);

/// Removes rows that go back in time and repeat times and values of earlier rows, as in overlapping archives.
/// Their number is noted.
void drop_repeats(RawRecord& raw, SampleFaults& faults);

/// Marks frames of zeros as lost: voltage, power, current and their angles are exactly zero, and V, P and Q
/// continue after them as before. If V or the power differs, the frames are kept. They are then a bolted
/// fault at the terminals, which a simulation may write as zeros. Frames of zeros at either end are lost too.
/// Lost and kept frames are noted.
void lose_zero_frames(RawRecord& raw, SampleFaults& faults);

}  // namespace swingbank::validate::record
