#pragma once
// SIGUSR1 and SIGTERM ask a run to save and stop: Slurm sends them before its time limit.

namespace swingbank {

/// Exit code of a run that was checkpointed and should be submitted again.
inline constexpr int kExitResubmit = 2;
/// From now on the two signals set a flag instead of ending the program.
void catch_soft_exit();
[[nodiscard]] bool soft_exit_requested();

}  // namespace swingbank
