#pragma once
// Leave one generator out: every fold trains on the other generators and is judged on rows it never saw.
#include <vector>

#include "train/run/run.hpp"

namespace swingbank::train::run {

/// Folds of one process: every size-th, from rank on.
std::vector<std::int32_t> share_of(const std::vector<std::int32_t>& folds, runtime::Place place);
/// Runs the folds in turn; stops after the first that was asked to stop.
RunOutcome cross_validate(const data::ShardStream& stream, RunRequest request,
                          const std::vector<std::int32_t>& folds);

}  // namespace swingbank::train::run
