#include "base/run_lock.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <utility>

#include "base/durable.hpp"
#include "base/problem.hpp"
#include "tests/mpi/store/sample_shard.hpp"

namespace {
int lock_error = 0;        // error number that the next locks return; 0: none
int lock_errors_left = 0;  // number of locks that return it
std::function<void()> before_next;
}  // namespace

/// Replaces libc's function, because a file system without locks is not available on every machine.
extern "C" int flock(int fd, int operation) noexcept {
  if (lock_errors_left > 0) {
    --lock_errors_left;
    errno = lock_error;
    return -1;
  }
  if (before_next) std::exchange(before_next, nullptr)();
  return static_cast<int>(::syscall(SYS_flock, fd, operation));
}

namespace swingbank {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct RunLockFile : ::testing::Test {
  void TearDown() override { lock_errors_left = 0; }
  [[nodiscard]] std::unique_ptr<RunLock> lock() const {
    return std::make_unique<RunLock>(file, LockWords{"dataset in use", "/data", "wait for it"},
                                     std::chrono::milliseconds(0));
  }
  [[nodiscard]] std::string refusal() const {
    try {
      (void)lock();
    } catch (const InputError& e) {
      return e.what();
    }
    return "taken";
  }
  test::Folder folder;
  std::filesystem::path file = folder.path / ".lock";
};

TEST_F(RunLockFile, RefusalNamesTheHolder) {
  ::setenv("SLURM_JOB_ID", "4711", 1);
  const auto first = lock();
  ::unsetenv("SLURM_JOB_ID");
  EXPECT_THAT(refusal(), AllOf(HasSubstr("dataset in use at /data (locked by process " +
                                         std::to_string(::getpid()) + " on "),
                               HasSubstr(", Slurm job 4711): wait for it")));
}

TEST_F(RunLockFile, IsReleasedWithItsHolderAndTheFileRemains) {
  lock().reset();
  EXPECT_TRUE(std::filesystem::exists(file));
  EXPECT_EQ(refusal(), "taken");
}

TEST_F(RunLockFile, ReportsFileSystemsWithoutLocks) {
  for (const int error : {ENOSYS, ENOLCK, EOPNOTSUPP}) {
    lock_error = error;
    lock_errors_left = 1;
    EXPECT_THAT(refusal(), AllOf(HasSubstr("the file system does not support flock"),
                                 HasSubstr(std::strerror(error)), Not(HasSubstr("in use"))));
    EXPECT_FALSE(std::filesystem::exists(file));
  }
}

TEST_F(RunLockFile, RepeatsInterruptedCalls) {
  lock_error = EINTR;
  lock_errors_left = 3;
  EXPECT_EQ(refusal(), "taken");
  EXPECT_EQ(lock_errors_left, 0);
}

TEST_F(RunLockFile, ReopensAFileRemovedBeforeLocking) {
  before_next = [&] { std::filesystem::remove(file); };
  const auto first = lock();
  EXPECT_TRUE(std::filesystem::exists(file));
  EXPECT_THAT(refusal(), HasSubstr("in use"));
}

TEST_F(RunLockFile, RemovesOnlyItsOwnFile) {
  write_text(file, "");
  lock()->withdraw();
  EXPECT_TRUE(std::filesystem::exists(file));
  std::filesystem::remove(file);
  lock()->withdraw();
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST_F(RunLockFile, ReportsForeignTextWithoutControlCharacters) {
  write_text(file, "\x1b[31mred\nsecond line");
  const int held = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(::flock(held, LOCK_EX | LOCK_NB), 0);
  EXPECT_THAT(refusal(), HasSubstr("(locked by [31mredsecond line)"));
  ::close(held);
}

TEST_F(RunLockFile, DoesNotFollowLinks) {
  const auto precious = folder.path / "precious";
  write_text(precious, "text");
  std::filesystem::create_symlink("precious", file);
  EXPECT_THAT(refusal(), HasSubstr("cannot open the lock file at " + file.string()));
  EXPECT_EQ(read_text(precious), "text");
}

}  // namespace
}  // namespace swingbank
