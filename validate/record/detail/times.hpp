#pragma once
// Times of records: stamps like "2024-05-01 12:00:00.033", and whether samples are evenly spaced.
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "validate/record/detail/build.hpp"

namespace swingbank::validate::record {

struct Stamp {
  long day = 0;        ///< since 1970-01-01; 0 for a time of day alone
  double second = 0;   ///< of the day
  int decimals = 0;    ///< of the seconds
  bool zoned = false;  ///< the text names a zone, and day and second are UTC
};

/// ISO 8601 ("2024-05-01T12:00:00.033Z", "2024-05-01 12:00:00.033"), "5/1/2024 12:00:00.033 PM" (month first
/// unless that cannot be) and "12:00:00.033". None: it is no such stamp.
std::optional<Stamp> parse_stamp(std::string_view text);

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
/// put back or is on another hour. Steps of all sizes, as a simulation with variable steps writes them,
/// become even ones. Everything else is a fault.
EvenRows settle_rows(const Rows& rows, Record& about, SampleFaults& faults);

}  // namespace swingbank::validate::record
