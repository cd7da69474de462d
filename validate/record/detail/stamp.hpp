#pragma once
// Parser of time stamps: ISO 8601, dates with month names, compact forms of historians, times of day.
#include <optional>
#include <string_view>

namespace swingbank::validate::record {

struct Stamp {
  long day = 0;            ///< days since 1970-01-01; 0 for a time of day without a date
  double second = 0;       ///< seconds since midnight [s]
  double resolution = 1;   ///< rounding of the seconds [s]
  bool zoned = false;      ///< the text states UTC or an offset from it, and day and second are UTC
  bool day_first = false;  ///< three numbers that were read as day, month, year
  bool in_hour = false;    ///< only minutes and seconds, as spreadsheets display times ("56:20.0")
};

/// Parses "2024-05-01T12:00:00.033Z", "5/1/2024 12:00:00.033 PM" (month first unless `day_first` or
/// impossible), "1.5.2024 12:00:00,033" (day first), "08-Aug-2026 12:56:20.000" and "Mar 13 2026 …" (months
/// in English, German, French, Spanish, Portuguese, Italian, Russian), "20260313 125620.000", "12:56:20:033",
/// "12:00:00.033" and "56:20.0". Returns no value for any other text.
std::optional<Stamp> parse_stamp(std::string_view text, bool day_first = false);

}  // namespace swingbank::validate::record
