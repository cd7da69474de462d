#pragma once
// Child processes: forked copies of this process, and other programs that run to their end.
#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace swingbank {

/// Forks a copy of this process that runs `work` and exits with its return value. Returns the process id, or
/// -1 with errno set if the fork fails. `work` must not throw. The child receives the signal `at_our_end` if
/// this process dies first. No other thread may run at the time of the fork.
pid_t start_child(const std::function<int()>& work, int at_our_end);
/// Waits until the child ends. Returns the status of waitpid(2).
int wait_for_child(pid_t child);

/// Options of `run_program`.
struct ProgramRun {
  /// Treatment of standard output: shown to the user, discarded, or returned in the result.
  enum class Output { shown, dropped, taken };
  Output output = Output::dropped;  ///< treatment of standard output
  bool silent = false;              ///< discard standard error
  double limit = 0.0;               ///< time limit [s] before SIGKILL; 0: none; for Output::taken only
};
/// Result of `run_program`.
struct ProgramEnd {
  std::string output;  ///< standard output, for Output::taken
  int status = 0;      ///< status of waitpid(2)
  bool late = false;   ///< whether the time limit was exceeded
  /// Returns the exit code, or 128 + the signal's number if a signal ended the program.
  [[nodiscard]] int code() const;
};
/// Runs a program to its end with the arguments `words`; words[0] is its name. Throws InputError if it cannot
/// be started.
ProgramEnd run_program(const std::filesystem::path& program, const std::vector<std::string>& words,
                       const ProgramRun& how);

}  // namespace swingbank
