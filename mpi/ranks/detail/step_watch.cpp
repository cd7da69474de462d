#include "mpi/ranks/detail/step_watch.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

namespace swingbank::mpi::ranks {

namespace {
void warn_slow_step(int rank, const std::string& step, const std::string& where,
                    std::chrono::duration<double> since, int error) {
  std::fprintf(stderr, "rank %d has tried to %s %s for %g s%s%s: the rank hangs, or the disk is slow\n", rank,
               step.c_str(), where.c_str(), since.count(),
               error == 0 ? "" : "; the system: ", error == 0 ? "" : std::strerror(error));
  std::fflush(stderr);
}
}  // namespace

StepWatch::StepWatch(int rank, std::string step, std::string where, std::chrono::milliseconds warn_after) {
  errno = 0;
  // Address of the watched thread's errno, which that thread does not change while it hangs.
  thread_ =
      std::thread([this, rank, step = std::move(step), where = std::move(where), warn_after, last = &errno] {
        std::unique_lock guard(mutex_);
        if (!wake_.wait_for(guard, warn_after, [this] { return ended_; }))
          warn_slow_step(rank, step, where, warn_after, __atomic_load_n(last, __ATOMIC_RELAXED));
      });
}

StepWatch::~StepWatch() {
  const int kept = errno;
  {
    const std::lock_guard guard(mutex_);
    ended_ = true;
  }
  wake_.notify_one();
  thread_.join();
  errno = kept;
}

}  // namespace swingbank::mpi::ranks
