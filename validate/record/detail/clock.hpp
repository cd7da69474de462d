#pragma once
// Inference of a missing unit of the time column, and plausibility of the sample interval.
#include "validate/record/detail/build.hpp"

namespace swingbank::validate::record {

/// Infers the unit of the time column from its values if its heading gives none. The units are seconds,
/// milliseconds, microseconds or nanoseconds since 1970, days of a spreadsheet (since 1899-12-30) or of
/// MATLAB (since year 0), and seconds from an arbitrary origin. Days are converted to seconds since the first
/// sample. The result is noted.
void settle_clock(RawRecord& raw);

/// Adds a problem, and returns true, if the time unit is probably wrong: the sample interval [s] is too long
/// for any swing, or a record in ms or a smaller unit is too short.
bool check_clock(const std::vector<double>& t, const ColumnMeaning& time, const ReadOptions& options,
                 const std::string& file, Problems& problems);

}  // namespace swingbank::validate::record
