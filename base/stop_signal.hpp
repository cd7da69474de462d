#pragma once
// Graceful stop on SIGTERM, SIGINT and SIGUSR1. The program finishes the current shards or ends the current
// fits, saves what it has reached, if anything, and exits with code 2.
#include <unistd.h>

#include <csignal>
#include <cstdlib>

#include "base/launcher.hpp"

namespace swingbank {

constexpr int kSubmitAgain = 2;  ///< exit code after a stop signal: run the command again

namespace detail {
inline volatile std::sig_atomic_t stop_asked = 0, interruptible = 0, first_rank = 1;
/// Prints "stopping" at once to confirm the signal. Async-signal-safe.
inline void say_stopping() {
  constexpr char text[] = "\nstopping\n";
  if (first_rank != 0) [[maybe_unused]]
    const auto written = ::write(STDERR_FILENO, text, sizeof text - 1);
}
}  // namespace detail
/// Installs handlers that record stop signals, so that the program can finish the current work. A
/// SIGINT after an earlier request to stop ends the process at once.
inline void catch_stop_signals() {
  detail::interruptible = 0;
  detail::first_rank = is_first_rank() ? 1 : 0;
  for (int s : {SIGTERM, SIGINT, SIGUSR1})
    std::signal(s, [](int number) {
      if (detail::stop_asked != 0 && number == SIGINT) std::_Exit(130);  // second Ctrl-C: exit at once
      if (detail::stop_asked == 0) detail::say_stopping();
      detail::stop_asked = 1;
    });
}
/// Returns whether a signal has asked to stop.
inline bool stop_asked() { return detail::stop_asked != 0; }

/// Exception of interruption_point(). Not a std::exception, so that no handler mistakes it for a failure.
struct Interrupted {};

/// Installs handlers: from now on, a stop signal ends the work at its next interruption point.
/// catch_stop_signals() switches this off. For commands that report the values reached so far.
inline void interrupt_on_stop_signals() {
  catch_stop_signals();
  detail::interruptible = 1;
}
/// Returns whether the current work must end.
inline bool interruption_asked() { return detail::interruptible != 0 && stop_asked(); }
/// Asks the current work to end at its next interruption point, as a stop signal does.
inline void ask_to_stop() { detail::stop_asked = 1; }

/// Guard that makes work during its lifetime interruptible: Ctrl-C ends it at the next interruption point.
/// The destructor restores the SIGINT handler of the host program, such as Python. In a thread other than the
/// main one, the guard leaves the handler unchanged.
class InterruptOnSigint {
 public:
  InterruptOnSigint() {
    if (detail::interruptible == 0) detail::stop_asked = 0;
    detail::interruptible = detail::interruptible + 1;
    if (::gettid() != ::getpid()) return;
    struct sigaction own = {};
    own.sa_handler = [](int) { ask_to_stop(); };
    installed_ = ::sigaction(SIGINT, &own, &before_) == 0;
  }
  InterruptOnSigint(const InterruptOnSigint&) = delete;
  InterruptOnSigint& operator=(const InterruptOnSigint&) = delete;
  ~InterruptOnSigint() {
    if (installed_) ::sigaction(SIGINT, &before_, nullptr);
    detail::interruptible = detail::interruptible - 1;
    if (detail::interruptible == 0) detail::stop_asked = 0;
  }

 private:
  bool installed_ = false;
  struct sigaction before_ = {};
};
/// Runs `work` until it ends or is interrupted. Values that it has assigned before an interruption remain.
template <class Work>
void until_interrupted(Work work) {
  try {
    work();
  } catch (const Interrupted&) {
  }
}
/// Throws Interrupted if the current work must end. Every loop that may take longer than some milliseconds
/// calls it: integration steps, iterations of a fit.
inline void interruption_point() {
  if (interruption_asked()) throw Interrupted{};
}

}  // namespace swingbank
