#pragma once
// Parallel processes without a launcher, forked after reading so that they share memory.
#include <functional>

#include "train/runtime/runtime.hpp"

namespace swingbank::train::run {

/// Runs `work` in `count` child processes, each with its rank, and returns their joint exit code: 1 if any
/// failed, else 2 if any was stopped, else 0. Passes soft-exit signals on. count = 1 runs in this process. No
/// thread may have been started before.
int run_processes(int count, const std::function<int(runtime::Place)>& work);

}  // namespace swingbank::train::run
