#pragma once
// Several processes of one program without a launcher: they share what was read before they parted.
#include <functional>

#include "train/runtime/runtime.hpp"

namespace swingbank::train::run {

/// Runs `work` in `count` child processes, each with its place, and returns the exit code of them all: 1 if
/// any failed, else 2 if any was stopped, else 0. Signals for a soft exit are passed on. count = 1: runs
/// here. No thread may have been started before.
int run_processes(int count, const std::function<int(runtime::Place)>& work);

}  // namespace swingbank::train::run
