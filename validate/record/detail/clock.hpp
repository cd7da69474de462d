#pragma once
// The unit of a time column that names none, and whether the steps between samples are those of a record.
#include "validate/record/detail/build.hpp"

namespace swingbank::validate::record {

/// Gives the time column a unit where its heading names none: its values are seconds, milliseconds,
/// microseconds or nanoseconds since 1970, days of a spreadsheet (since 1899-12-30) or of MATLAB (since year
/// 0), or seconds from any time. Days count from the first sample afterwards. What was decided is noted.
void settle_clock(RawRecord& raw);

/// Adds a problem where the steps [s] are too long for any swing, or a record in ms or less is too short: the
/// unit is likely another one. True where there is such a problem.
bool check_clock(const std::vector<double>& t, const ColumnMeaning& time, const ReadOptions& options,
                 const std::string& file, Problems& problems);

}  // namespace swingbank::validate::record
