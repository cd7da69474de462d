#pragma once
// SIGTERM, SIGINT and SIGUSR1 ask for a soft exit: finish the shards at hand, or end the fits at hand, leave
// everything durable, exit with 2.
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>

namespace swingbank {

constexpr int kSubmitAgain = 2;  ///< exit code: checkpointed, submit again

namespace detail {
inline volatile std::sig_atomic_t stop_asked = 0, interruptible = 0, first_rank = 1;
/// Whether this process is no rank of an MPI run, or its first.
inline bool is_first_rank() {
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"})
    if (const char* rank = std::getenv(name); rank && std::strcmp(rank, "0") != 0) return false;
  return true;
}
/// Prints "stopping" at once, so that the user knows that the signal was received. For signal handlers.
inline void say_stopping() {
  constexpr char text[] = "\nstopping\n";
  if (first_rank != 0) [[maybe_unused]]
    const auto written = ::write(STDERR_FILENO, text, sizeof text - 1);
}
}  // namespace detail
/// Stop signals are noted; the work at hand is finished.
inline void catch_stop_signals() {
  detail::interruptible = 0;
  detail::first_rank = detail::is_first_rank() ? 1 : 0;
  for (int s : {SIGTERM, SIGINT, SIGUSR1})
    std::signal(s, [](int number) {
      if (detail::stop_asked != 0 && number == SIGINT) std::_Exit(130);  // a second Ctrl-C means it
      if (detail::stop_asked == 0) detail::say_stopping();
      detail::stop_asked = 1;
    });
}
inline bool stop_asked() { return detail::stop_asked != 0; }

/// Thrown by interruption_point(). No std::exception, so that nothing takes it for a failure of the work.
struct Interrupted {};

/// Stop signals end the work at its next interruption point, until catch_stop_signals() is called: for
/// commands that keep what was reached until then and say so.
inline void interrupt_on_stop_signals() {
  catch_stop_signals();
  detail::interruptible = 1;
}
/// Whether the work at hand shall end.
inline bool interruption_asked() { return detail::interruptible != 0 && stop_asked(); }
/// Does the work until it is interrupted. What it has assigned until then stays.
template <class Work>
void until_interrupted(Work work) {
  try {
    work();
  } catch (const Interrupted&) {
  }
}
/// Throws Interrupted where the work at hand shall end. Stands in every loop that may take longer than some
/// milliseconds: steps of an integration, iterations of a fit.
inline void interruption_point() {
  if (interruption_asked()) throw Interrupted{};
}

}  // namespace swingbank
