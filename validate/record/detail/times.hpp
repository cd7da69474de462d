#pragma once
// Times of records: stamps like "2024-05-01 12:00:00.033", and whether samples are evenly spaced.
#include <optional>
#include <string_view>
#include <vector>

#include "validate/record/detail/build.hpp"

namespace swingbank::validate::record {

struct Stamp {
  long day = 0;       ///< since 1970-01-01; 0 for a time of day alone
  double second = 0;  ///< of the day
  int decimals = 0;   ///< of the seconds
};

/// ISO 8601 ("2024-05-01T12:00:00.033Z", "2024-05-01 12:00:00.033"), "5/1/2024 12:00:00.033 PM" (month first
/// unless that cannot be) and "12:00:00.033". None: it is no such stamp.
std::optional<Stamp> parse_stamp(std::string_view text);

/// Times must increase by one and the same step. 1 % is what rounding to 0.1 ms leaves at 120 samples/s;
/// times rounded more coarsely (`resolution` [s], at most 0.15 of a step) that fit an even grid are put on
/// it, and `about.notes` says so. Everything else is a fault: repeated, backwards, gaps.
void settle_times(std::vector<double>& t, double resolution, Record& about, SampleFaults& faults);

}  // namespace swingbank::validate::record
