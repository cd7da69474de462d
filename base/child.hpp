#pragma once
// Processes that this one starts and waits for: copies of itself, and other programs.
#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace swingbank {

/// A copy of this process that does `work` and ends with its code; no exception may leave it. It gets the
/// signal `at_our_end` when this process dies before it. -1, with errno set, if it cannot be started. No
/// other thread may run.
pid_t start_child(const std::function<int()>& work, int at_our_end);
/// Waits for its end; the status as waitpid(2) gives it.
int wait_for_child(pid_t child);

struct ProgramRun {
  enum class Output { shown, dropped, taken };
  Output output = Output::dropped;  ///< what it prints
  bool silent = false;              ///< its messages (stderr) are dropped
  double limit = 0.0;               ///< [s] after which it is killed; 0: none; only where the output is taken
};
struct ProgramEnd {
  std::string output;  ///< where it was taken
  int status = 0;      ///< as waitpid(2) gives it
  bool late = false;   ///< it took longer than the limit
  /// Its exit code; 128 + signal if a signal ended it.
  [[nodiscard]] int code() const;
};
/// Runs a program, words[0] as its name, to its end. Throws InputError where it cannot be started.
ProgramEnd run_program(const std::filesystem::path& program, const std::vector<std::string>& words,
                       const ProgramRun& how);

}  // namespace swingbank
