#include "base/write_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/problem.hpp"

namespace swingbank {
namespace {

bool write_all(int descriptor, std::string_view content) {
  while (!content.empty()) {
    const ssize_t n = ::write(descriptor, content.data(), content.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    content.remove_prefix(static_cast<std::size_t>(n));
  }
  return ::fsync(descriptor) == 0;
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& why) {
  throw InputError({"cannot write", file.string(), why, "choose a writable folder with room on its disk"});
}

}  // namespace

void write_file(const std::filesystem::path& file, std::string_view content) {
  std::error_code error;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), error);
  if (error) refuse(file, error.message());
  const std::string temporary = file.string() + ".part";
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor < 0) refuse(file, std::strerror(errno));
  const bool written = write_all(descriptor, content);
  const int failure = errno;
  const bool closed = ::close(descriptor) == 0;
  if (!written || !closed) {
    ::unlink(temporary.c_str());
    refuse(file, std::strerror(written ? errno : failure));
  }
  std::filesystem::rename(temporary, file, error);
  if (error) {
    ::unlink(temporary.c_str());
    refuse(file, error.message());
  }
}

}  // namespace swingbank
