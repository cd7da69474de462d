#pragma once
// Parallel processes without a launcher, forked after the dataset is read, so that they share its memory.
#include <functional>

#include "train/runtime/runtime.hpp"

namespace swingbank::train::run {

/// Runs `work` in `count` child processes, each with its rank. Returns the joint exit code: 1 if any failed,
/// else 2 if any was stopped, else 0. Forwards stop signals to the children. With count = 1, runs `work` in
/// this process. No thread may have been started before.
int run_processes(int count, const std::function<int(runtime::Place)>& work);

}  // namespace swingbank::train::run
