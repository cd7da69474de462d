#pragma once
// Parallel loop over independent tasks, with exceptions and progress.
#include <omp.h>

#include <concepts>
#include <exception>
#include <mutex>

namespace swingbank {

/// Calls work(k) for k = 0 to n-1 on `threads` threads, in any order. 0 threads: OpenMP's number, one per
/// core unless OMP_NUM_THREADS or omp_set_num_threads gives another. After each task, calls done(number
/// finished) or done(number finished, k) under a lock. Rethrows the first exception of a task after all tasks
/// have ended; a task that throws does not count as finished.
template <class Work, class Done>
void in_parallel(std::size_t n, Work work, Done done, int threads = 0) {
  std::exception_ptr failure;
  std::mutex lock;
  int finished = 0;
  const auto count = static_cast<long>(n);
  const int cores = threads > 0 ? threads : omp_get_max_threads();
#pragma omp parallel for schedule(dynamic) num_threads(cores)
  for (long k = 0; k < count; ++k) {
    std::exception_ptr own;
    try {
      work(static_cast<std::size_t>(k));
    } catch (...) {
      own = std::current_exception();
    }
    const std::lock_guard guard(lock);
    if (own && !failure) failure = own;
    if (own) continue;
    ++finished;
    if constexpr (std::invocable<Done, int, std::size_t>)
      done(finished, static_cast<std::size_t>(k));
    else
      done(finished);
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace swingbank
