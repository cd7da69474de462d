#include "base/run_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <utility>

#include "base/durable.hpp"
#include "base/problem.hpp"
#include "base/until_done.hpp"

namespace swingbank {

namespace {

/// Returns the printable characters of a lock file, which any process may have written.
std::string owner_in(int fd) {
  std::array<char, 200> text{};
  const ssize_t n = ::pread(fd, text.data(), text.size(), 0);
  std::string owner(text.data(), static_cast<std::size_t>(std::max<ssize_t>(n, 0)));
  std::erase_if(owner, [](char c) { return c < ' ' || c > '~'; });
  return owner.empty() ? "another process" : owner;
}

std::string this_process() {
  std::array<char, 256> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) std::strcpy(host.data(), "an unknown host");
  std::string owner = "process " + std::to_string(::getpid()) + " on " + host.data();
  if (const char* job = std::getenv("SLURM_JOB_ID")) owner += ", Slurm job " + std::string(job);
  return owner;
}

}  // namespace

RunLock::RunLock(std::filesystem::path file, LockWords words, std::chrono::milliseconds patience, Kind kind)
    : file_(std::move(file)), words_(std::move(words)), kind_(kind) {
  const auto end = std::chrono::steady_clock::now() + patience;
  try {
    for (;;) {
      open();
      if (try_lock()) {
        if (still_has_its_name()) break;
      } else {
        if (std::chrono::steady_clock::now() >= end) refuse();
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
      }
      ::close(std::exchange(fd_, -1));
    }
  } catch (...) {
    if (fd_ >= 0) ::close(fd_);
    throw;
  }
  write_owner();
}

RunLock::~RunLock() {
  if (fd_ >= 0) ::close(fd_);
}

void RunLock::open() {
  constexpr int kFlags = O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW;
  fd_ = until_done([&] {
    const int created = ::open(file_.c_str(), kFlags | O_EXCL, 0644);
    created_ = created >= 0;
    return created < 0 && errno == EEXIST ? ::open(file_.c_str(), kFlags, 0644) : created;
  });
  if (fd_ < 0) raise_file_error(file_, errno, "cannot open the lock file");
}

bool RunLock::try_lock() {
  const int how = (kind_ == Kind::alone ? LOCK_EX : LOCK_SH) | LOCK_NB;
  if (until_done([&] { return ::flock(fd_, how); }) == 0) return true;
  if (errno == EWOULDBLOCK) return false;
  const std::string why = std::strerror(errno);
  withdraw();
  throw InputError({"cannot lock the folder", file_.string(),
                    "the file system does not support flock: " + why +
                        "; two runs could write to the folder at the same time",
                    "use another disk or mount with lock support (Lustre: -o flock)"});
}

/// Returns whether the locked file is still the file of this name. Another holder may have removed it between
/// open and lock.
bool RunLock::still_has_its_name() const {
  struct stat held {
  }, named{};
  return ::fstat(fd_, &held) == 0 && ::stat(file_.c_str(), &named) == 0 && held.st_dev == named.st_dev &&
         held.st_ino == named.st_ino;
}

void RunLock::refuse() const {
  throw InputError({words_.what, words_.where, "locked by " + owner_in(fd_), words_.remedy});
}

/// Writes this process into the file as the holder. Ignores errors such as a full disk, because the text is
/// only informative.
void RunLock::write_owner() const {
  const std::string owner =
      this_process() + (kind_ == Kind::shared ? " or another part of the dataset" : "") + "\n";
  if (::ftruncate(fd_, 0) == 0 && ::pwrite(fd_, owner.data(), owner.size(), 0) < 0) return;
}

void RunLock::withdraw(bool always) {
  if (fd_ >= 0 && (created_ || always)) ::unlink(file_.c_str());
}

}  // namespace swingbank
