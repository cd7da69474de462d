#pragma once
// A call of the system made again where a signal or a file system's server interrupted it.
#include <cerrno>

namespace swingbank {

/// Result of the first call that does not end with EINTR.
template <class Call>
auto until_done(const Call& call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

}  // namespace swingbank
