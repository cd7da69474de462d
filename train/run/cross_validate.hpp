#pragma once
// Cross-validation by leaving one generator out: each fold trains on the other generators and is tested on
// the one left out.
#include <vector>

#include "train/run/run.hpp"

namespace swingbank::train::run {

/// Returns the folds of one process: every place.size-th fold, from index place.rank.
std::vector<std::int32_t> share_of(const std::vector<std::int32_t>& folds, runtime::Place place);
/// Runs the folds in order; ends after the first fold that a signal stops.
RunOutcome cross_validate(const data::ShardStream& stream, RunRequest request,
                          const std::vector<std::int32_t>& folds);

}  // namespace swingbank::train::run
