#pragma once
// Times of records on an even grid: whether samples are evenly spaced, and which of them belong to it.
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "validate/record/detail/build.hpp"

namespace swingbank::validate::record {

/// What is known of the rows of a file before they stand on an even grid.
struct Rows {
  const std::vector<double>& t;  ///< [s]
  double resolution = 0;         ///< what t is rounded to [s]; 0: not known
  bool uneven = false;           ///< any distance is meant: straight lines join the samples
  std::function<bool(std::size_t, std::size_t)> same;  ///< do two rows hold the same values?
};
/// Evenly spaced instants, and the row of each: between two rows where it is no whole number, NaN where no
/// row was recorded.
struct EvenRows {
  std::vector<double> t;
  std::vector<double> place;
};

/// Times must increase by one and the same step. 1 % is what rounding to 0.1 ms leaves at 120 samples/s;
/// times rounded more coarsely (`resolution`, at most 0.75 of a step) that fit an even grid are put on it.
/// Mended and told in about.notes are: frames that are missing, stamps that are repeated, a clock that was
/// put back or is on another hour, and a few rows between the samples, which are left out. Steps of all
/// sizes, as a simulation with variable steps writes them, become even ones. Everything else is a fault.
EvenRows settle_rows(const Rows& rows, Record& about, SampleFaults& faults);

}  // namespace swingbank::validate::record
