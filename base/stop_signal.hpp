#pragma once
// SIGTERM, SIGINT and SIGUSR1 ask for a soft exit: finish the shards at hand, leave everything durable, exit
// with 2.
#include <csignal>
#include <cstdlib>

namespace swingbank {

constexpr int kSubmitAgain = 2;  ///< exit code: checkpointed, submit again

namespace detail {
inline volatile std::sig_atomic_t stop_asked = 0;
}
inline void catch_stop_signals() {
  for (int s : {SIGTERM, SIGINT, SIGUSR1})
    std::signal(s, [](int number) {
      if (detail::stop_asked != 0 && number == SIGINT) std::_Exit(130);  // a second Ctrl-C means it
      detail::stop_asked = 1;
    });
}
inline bool stop_asked() { return detail::stop_asked != 0; }

}  // namespace swingbank
