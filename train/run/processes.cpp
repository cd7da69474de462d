#include "train/run/processes.hpp"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <vector>

#include "base/child.hpp"
#include "base/problem.hpp"
#include "base/stop_signal.hpp"

namespace swingbank::train::run {
namespace {

void end_all(const std::vector<pid_t>& children, int signal) {
  for (const pid_t child : children) kill(child, signal);
}

/// Waits for one child; passes a stop request on to all running children.
int wait_for(pid_t child, const std::vector<pid_t>& running) {
  bool passed_on = false;
  for (int status = 0;;) {
    if (stop_asked() && !passed_on) {
      end_all(running, SIGTERM);
      passed_on = true;
    }
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) {
      if (WIFEXITED(status)) return WEXITSTATUS(status);
      fmt::print(stderr, "signal {} ({}) ended a training process: run the same command again to continue\n",
                 WTERMSIG(status), strsignal(WTERMSIG(status)));
      return 1;
    }
    usleep(50'000);
  }
}

}  // namespace

int run_processes(int count, const std::function<int(runtime::Place)>& work) {
  if (count <= 1) return work({});
  std::vector<pid_t> children;
  for (int i = 0; i < count; ++i) {
    // If this process dies, the child receives SIGTERM: it saves a checkpoint and ends.
    const pid_t child = start_child([&] { return work({i, count}); }, SIGTERM);
    if (child < 0) {
      const int error = errno;
      end_all(children, SIGTERM);
      throw InputError({fmt::format("process {} of {} cannot be started", i + 1, count), "--processes",
                        std::strerror(error), "give a smaller number"});
    }
    children.push_back(child);
  }
  int worst = 0;
  for (std::size_t i = 0; i < children.size(); ++i) {
    const int code =
        wait_for(children[i], {children.begin() + static_cast<std::ptrdiff_t>(i), children.end()});
    worst = code == 0 ? worst : code == kSubmitAgain && worst != 1 ? kSubmitAgain : 1;
  }
  return worst;
}

}  // namespace swingbank::train::run
