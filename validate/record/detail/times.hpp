#pragma once
// Conversion of a record's times to a uniform grid.
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "validate/record/detail/build.hpp"

namespace swingbank::validate::record {

/// Rows of a file before their assignment to a uniform grid.
struct Rows {
  const std::vector<double>& t;  ///< [s]
  double resolution = 0;         ///< rounding of t [s]; 0: not known
  bool uneven = false;           ///< sample times are arbitrary, and values are linear between samples
  std::function<bool(std::size_t, std::size_t)> same;  ///< whether two rows hold the same values
};
/// Evenly spaced times, and the row of each: fractional between two rows, NaN if no row was recorded.
struct EvenRows {
  std::vector<double> t;
  std::vector<double> place;
};

/// Returns the uniform grid of the rows' times, which must increase by a constant step within 1 %. The
/// tolerance covers rounding to 0.1 ms at up to 100 samples/s. Times rounded more coarsely (`resolution`, at
/// most 0.75 of a step) are replaced by a uniform grid, if they fit one. The function repairs missing frames,
/// repeated stamps, clock adjustments (up to 1.5 s, or multiples of half an hour), and a few rows off the
/// grid. Repairs are noted in about.notes. Rows with the variable steps of a simulation are resampled.
/// Everything else is a fault.
EvenRows settle_rows(const Rows& rows, Record& about, SampleFaults& faults);

}  // namespace swingbank::validate::record
