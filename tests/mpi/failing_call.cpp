// Library for LD_PRELOAD: one call of one process fails with a given error. Calls are counted from 1 in each
// process, file calls (below one folder) and allocations by operator new separately.
// - FAILING_ERROR: memory (std::bad_alloc), or an errno for a file call; kill: SIGKILL instead of the call;
//   trace: nothing fails, and each file call adds a line "trace CALL PATH" to the log; absent: only counts
// - FAILING_AT: the call that fails
// - FAILING_CALL: only file calls of this name count; absent: all
// - FAILING_RANK: the rank of the failure (OpenMPI's OMPI_COMM_WORLD_RANK; 0 without a launcher)
// - FAILING_UNDER: absolute path of the folder
// - FAILING_LOG: file for a line "failed CALL PATH" after the failure, and "count FILES ALLOCATIONS" at exit
#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <utility>

namespace {

std::atomic<long> file_calls{0}, allocations{0};

constexpr int kMemory = -1, kKill = -2, kTrace = -3;

int error_of(const char* word) {
  if (std::strcmp(word, "memory") == 0) return kMemory;
  if (std::strcmp(word, "kill") == 0) return kKill;
  if (std::strcmp(word, "trace") == 0) return kTrace;
  return std::atoi(word);
}

struct Order {
  const char* under = std::getenv("FAILING_UNDER");
  const char* log = std::getenv("FAILING_LOG");
  const char* call = std::getenv("FAILING_CALL");
  int error = 0;  ///< 0: none; otherwise an errno or one of the values below
  long at = 0;
  bool meant = false;
  Order() {
    const char *rank = std::getenv("OMPI_COMM_WORLD_RANK"), *wanted = std::getenv("FAILING_RANK");
    meant = log != nullptr &&
            std::atoi(rank != nullptr ? rank : "0") == std::atoi(wanted != nullptr ? wanted : "0");
    if (const char* n = std::getenv("FAILING_AT")) at = std::atol(n);
    if (const char* e = std::getenv("FAILING_ERROR")) error = error_of(e);
  }
};
const Order& order() {
  static const Order o;
  return o;
}

/// Uses system calls, because interposed functions must not be called here.
void note(const char* line, int length) {
  const int fd =
      static_cast<int>(syscall(SYS_openat, AT_FDCWD, order().log, O_WRONLY | O_CREAT | O_APPEND, 0644));
  if (fd < 0) return;
  syscall(SYS_write, fd, line, length);
  syscall(SYS_close, fd);
}

struct Count {
  ~Count() {
    char line[80];
    if (order().meant)
      note(line, std::snprintf(line, sizeof line, "count %ld %ld\n", file_calls.load(), allocations.load()));
  }
} count;

/// Returns whether this call on `path` fails, and sets errno if so.
bool fails(const char* call, const char* path) {
  const Order& o = order();
  if (!o.meant || o.under == nullptr || path == nullptr) return false;
  if (o.call != nullptr && std::strcmp(o.call, call) != 0) return false;
  const std::size_t n = std::strlen(o.under);
  if (std::strncmp(path, o.under, n) != 0) return false;
  const bool reached = ++file_calls == o.at;
  char line[700];
  if (o.error == kTrace) note(line, std::snprintf(line, sizeof line, "trace %s %.500s\n", call, path));
  if (!reached || o.error == 0 || o.error == kMemory || o.error == kTrace) return false;
  note(line, std::snprintf(line, sizeof line, "failed %s %.500s\n", call, path));
  if (o.error == kKill) ::kill(::getpid(), SIGKILL);
  errno = o.error;
  return true;
}
bool fails(const char* call, int fd) {
  if (!order().meant) return false;
  char link[40], path[600];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t n = readlink(link, path, sizeof path - 1);
  if (n <= 0) return false;
  path[n] = '\0';
  return fails(call, path);
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

void* allocate(std::size_t bytes, std::size_t alignment) {
  if (const Order& o = order(); o.meant && ++allocations == o.at && o.error == kMemory) {
    note("failed new memory\n", 18);
    throw std::bad_alloc();
  }
  if (bytes == 0) bytes = 1;
  void* p = alignment == 0 ? std::malloc(bytes)
                           : std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  if (p == nullptr) throw std::bad_alloc();
  return p;
}

}  // namespace

void* operator new(std::size_t bytes) { return allocate(bytes, 0); }
void* operator new[](std::size_t bytes) { return allocate(bytes, 0); }
void* operator new(std::size_t bytes, std::align_val_t a) {
  return allocate(bytes, static_cast<std::size_t>(a));
}
void* operator new[](std::size_t bytes, std::align_val_t a) {
  return allocate(bytes, static_cast<std::size_t>(a));
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete[](void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t) noexcept { std::free(p); }
void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete[](void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }

// NOLINTBEGIN: names of the system
#pragma GCC diagnostic ignored "-Wshadow"  // flock is also a structure
#define INTERPOSE(type, name, arguments, values, key, failed) \
  extern "C" type name arguments {                            \
    static const auto real = next<type(*) arguments>(#name);  \
    return fails(#name, key) ? (failed) : real values;        \
  }
#define INTERPOSE_OPEN(name)                                                       \
  extern "C" int name(const char* path, int flags, ...) {                          \
    static const auto real = next<int (*)(const char*, int, ...)>(#name);          \
    va_list more;                                                                  \
    va_start(more, flags);                                                         \
    const int mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, int) : 0; \
    va_end(more);                                                                  \
    return fails(#name, path) ? -1 : real(path, flags, mode);                      \
  }
INTERPOSE_OPEN(open)
INTERPOSE_OPEN(open64)
INTERPOSE(FILE*, fopen, (const char* path, const char* mode), (path, mode), path, nullptr)
INTERPOSE(FILE*, fopen64, (const char* path, const char* mode), (path, mode), path, nullptr)
INTERPOSE(DIR*, opendir, (const char* path), (path), path, nullptr)
INTERPOSE(ssize_t, read, (int fd, void* to, size_t n), (fd, to, n), fd, -1)
INTERPOSE(ssize_t, pread, (int fd, void* to, size_t n, off_t at), (fd, to, n, at), fd, -1)
INTERPOSE(ssize_t, pread64, (int fd, void* to, size_t n, off64_t at), (fd, to, n, at), fd, -1)
INTERPOSE(ssize_t, preadv, (int fd, const iovec* v, int n, off_t at), (fd, v, n, at), fd, -1)
INTERPOSE(ssize_t, write, (int fd, const void* from, size_t n), (fd, from, n), fd, -1)
INTERPOSE(ssize_t, writev, (int fd, const iovec* v, int n), (fd, v, n), fd, -1)
INTERPOSE(ssize_t, pwrite, (int fd, const void* from, size_t n, off_t at), (fd, from, n, at), fd, -1)
INTERPOSE(ssize_t, pwrite64, (int fd, const void* from, size_t n, off64_t at), (fd, from, n, at), fd, -1)
INTERPOSE(ssize_t, pwritev, (int fd, const iovec* v, int n, off_t at), (fd, v, n, at), fd, -1)
INTERPOSE(int, fsync, (int fd), (fd), fd, -1)
INTERPOSE(int, ftruncate, (int fd, off_t n), (fd, n), fd, -1)
INTERPOSE(int, ftruncate64, (int fd, off64_t n), (fd, n), fd, -1)
INTERPOSE(int, fallocate, (int fd, int mode, off_t at, off_t n), (fd, mode, at, n), fd, -1)
INTERPOSE(int, flock, (int fd, int what), (fd, what), fd, -1)
INTERPOSE(int, rename, (const char* from, const char* to), (from, to), from, -1)
INTERPOSE(int, unlink, (const char* path), (path), path, -1)
INTERPOSE(int, mkdir, (const char* path, mode_t mode), (path, mode), path, -1)
// A failing close() closes the descriptor nevertheless, as in Linux.
extern "C" int close(int fd) {
  static const auto real = next<int (*)(int)>("close");
  const bool failed = fails("close", fd);
  const int error = errno, result = real(fd);
  if (!failed) return result;
  errno = error;
  return -1;
}
// NOLINTEND
