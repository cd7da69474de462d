#pragma once
// Independent pieces of work on all cores, with exceptions and progress.
#include <omp.h>

#include <exception>
#include <mutex>

namespace swingbank::validate {

/// Calls work(k) for every k < n, in any order, and done(how many are finished) after each, one at a time.
/// The first exception of a piece is thrown again once all have ended.
template <class Work, class Done>
void in_parallel(std::size_t n, Work work, Done done) {
  std::exception_ptr failure;
  std::mutex lock;
  int finished = 0;
  const auto count = static_cast<long>(n);
#pragma omp parallel for schedule(dynamic)
  for (long k = 0; k < count; ++k) {
    std::exception_ptr own;
    try {
      work(static_cast<std::size_t>(k));
    } catch (...) {
      own = std::current_exception();
    }
    const std::lock_guard guard(lock);
    if (own && !failure) failure = own;
    if (!own) done(++finished);
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace swingbank::validate
