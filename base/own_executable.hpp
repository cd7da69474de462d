#pragma once
// Path of the running executable, also where /proc is not mounted.
#include <sys/auxv.h>

#include <filesystem>
#include <system_error>

namespace swingbank {

/// Returns the path of the running executable without symbolic links: the target of /proc/self/exe or,
/// without /proc, the path by which the kernel started it (AT_EXECFN, getauxval(3)). Empty if `error` is set.
inline std::filesystem::path own_executable(std::error_code& error) {
  const auto linked = std::filesystem::read_symlink("/proc/self/exe", error);
  if (!error) return linked;
  const auto* started = reinterpret_cast<const char*>(::getauxval(AT_EXECFN));
  return started ? std::filesystem::canonical(started, error) : std::filesystem::path();
}

}  // namespace swingbank
