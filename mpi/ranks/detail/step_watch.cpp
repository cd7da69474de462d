#include "mpi/ranks/detail/step_watch.hpp"

#include <mpi.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <utility>

namespace swingbank::mpi::ranks {

namespace {
constexpr std::chrono::seconds kStepTold{10};

void tell(int rank, const std::string& step, const std::string& where, int error) {
  std::fprintf(stderr, "rank %d has tried to %s %s for %d s%s%s: it hangs, or the disk is slow\n", rank,
               step.c_str(), where.c_str(), static_cast<int>(kStepTold.count()),
               error == 0 ? "" : "; the system: ", error == 0 ? "" : std::strerror(error));
  std::fflush(stderr);
}
}  // namespace

StepWatch::StepWatch(std::string step, std::string where) {
  int rank;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  errno = 0;
  // The watched thread's own errno. It writes no more of it while it hangs.
  thread_ = std::thread([this, rank, step = std::move(step), where = std::move(where), last = &errno] {
    std::unique_lock guard(mutex_);
    if (!wake_.wait_for(guard, kStepTold, [this] { return ended_; }))
      tell(rank, step, where, __atomic_load_n(last, __ATOMIC_RELAXED));
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
