#pragma once
// Retry of system calls that a signal or a file server has interrupted.
#include <unistd.h>

#include <cerrno>
#include <string_view>

namespace swingbank {

/// Repeats `call` as long as it fails with EINTR. Returns its result.
template <class Call>
auto until_done(const Call& call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

/// Writes all of `bytes`. Returns false with errno set on failure.
inline bool write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = until_done([&] { return ::write(fd, bytes.data(), bytes.size()); });
    if (n == 0) errno = ENOSPC;
    if (n <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

}  // namespace swingbank
