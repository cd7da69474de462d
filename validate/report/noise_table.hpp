#pragma once
// Methods against levels of measurement noise: what a network has to be better than, and what nobody can be.
#include <span>

#include "validate/report/page.hpp"
#include "validate/report/run_result.hpp"

namespace swingbank::validate::report {

/// Of the runs of one table, preset and dataset, without control runs: one row per method, one column per
/// level. A cell: the mean of the raw MSE over the generators left out, then in brackets its ratio to
/// predict-the-mean, its ratio to the floor over the runs that have one, and its spread over seeds.
Table noise_table(std::span<const RunResult> runs);
/// Whether there is more than one method or level to compare.
bool has_noise_table(std::span<const RunResult> runs);

}  // namespace swingbank::validate::report
