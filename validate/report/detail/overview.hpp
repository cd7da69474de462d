#pragma once
// First table of the report: the thesis's figures beside those of networks, searches and the floor.
#include "validate/report/detail/summary.hpp"
#include "validate/report/document.hpp"

namespace swingbank::validate::report {

/// One row for each table, noise level and statistic: the mean over the excluded generators, the worst of
/// them, and #39, which is unlike the others. The columns select among all presets and datasets of the table.
Table overview_table(const std::vector<Task>& tasks);

}  // namespace swingbank::validate::report
