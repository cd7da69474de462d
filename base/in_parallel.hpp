#pragma once
// Independent pieces of work on all cores, with exceptions and progress.
#include <omp.h>

#include <concepts>
#include <exception>
#include <mutex>

namespace swingbank {

/// Calls work(k) for every k < n, in any order, and after each, one at a time, done(how many are finished) or
/// done(how many, k). On `threads` cores, 0: all. The first exception of a piece is thrown again once all
/// have ended.
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
