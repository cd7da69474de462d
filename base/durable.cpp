#include "base/durable.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <xxhash.h>

#include <cerrno>
#include <cstring>
#include <functional>
#include <future>
#include <memory>
#include <utility>
#include <vector>

#include "base/inputs_kept.hpp"
#include "base/problem.hpp"
#include "base/publish_hashed.hpp"
#include "base/until_done.hpp"

namespace swingbank {

namespace fs = std::filesystem;

namespace {

std::string remedy_for(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "free some space or choose another folder, then run the command again";
    case EACCES:
    case EPERM:
    case EROFS:
      return "choose a writable folder, or correct its permissions";
    case ENOTDIR:
    case EEXIST:
      return "choose another folder: a file has this name";
    case EISDIR:
      return "choose another name: a folder has this name";
    case ENOENT:
      return "check the path";
    default:
      return "check the disk, then run the command again";
  }
}

class Descriptor {
 public:
  Descriptor(const fs::path& file, int flags)
      : Descriptor(until_done([&] { return ::open(file.c_str(), flags | O_CLOEXEC); })) {}
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_;
};

/// Opens the temporary file for writing. Removes an existing file first and refuses a link created meanwhile.
int open_new(const fs::path& temporary) {
  if (::unlink(temporary.c_str()) != 0 && errno != ENOENT) return -1;
  return until_done(
      [&] { return ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644); });
}

int flush(int fd) {
  return until_done([&] { return ::fsync(fd); });
}

/// Passes the bytes of a file to `take`, 1 MiB at a time. Throws InputError on a read error.
void read_pieces(const fs::path& file, const std::function<void(std::string_view)>& take) {
  const Descriptor d(file, O_RDONLY);
  if (d.get() < 0) raise_file_error(file, errno, "cannot read the file");
  std::vector<char> piece(std::size_t{1} << 20);
  for (;;) {
    const ssize_t n = until_done([&] { return ::read(d.get(), piece.data(), piece.size()); });
    if (n < 0) raise_file_error(file, errno, "cannot read the file");
    if (n == 0) return;
    take({piece.data(), static_cast<std::size_t>(n)});
  }
}

}  // namespace

void raise_file_error(const fs::path& file, int error, const std::string& what) {
  throw InputError({what, file.string(), std::strerror(error), remedy_for(error)});
}

fs::path temporary_name(const fs::path& file) {
  return file.parent_path() / ("." + file.filename().string() + ".part");
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) raise_file_error(folder, error.value(), "cannot create the folder");
}

void flush_folder(const fs::path& folder) {
  const Descriptor d(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY);
  if (d.get() < 0 || flush(d.get()) != 0) raise_file_error(folder, errno, "cannot flush the folder");
}

void reserve(const fs::path& file, std::uint64_t bytes) {
  const fs::path temporary = temporary_name(file);
  const Descriptor d(open_new(temporary));
  if (d.get() < 0) raise_file_error(file, errno, "cannot write the file");
  // Uses fallocate, because posix_fallocate would write every block on file systems without fallocate.
  const auto ask = [&] { return ::fallocate(d.get(), 0, 0, static_cast<off_t>(bytes)); };
  if (bytes == 0 || until_done(ask) == 0 || errno == EOPNOTSUPP) return;
  const int error = errno;
  ::unlink(temporary.c_str());
  raise_file_error(file, error, "cannot reserve " + std::to_string(bytes) + " bytes for the file");
}

void flush_temporary(const fs::path& file) {
  const Descriptor d(temporary_name(file), O_RDONLY | O_NOFOLLOW);
  if (d.get() < 0 || flush(d.get()) != 0) raise_file_error(file, errno, "cannot flush the file to the disk");
}

namespace {

/// Publishes a file. While another thread flushes it, calls `meanwhile` with the temporary name.
void publish_and(const fs::path& file, const std::function<void(const fs::path&)>& meanwhile) {
  const fs::path temporary = temporary_name(file);
  try {
    const Descriptor d(temporary, O_RDONLY | O_NOFOLLOW);
    const auto flushed = [&d] { return flush(d.get()) != 0 ? errno : 0; };
    int error = d.get() < 0 ? errno : 0;
    if (error == 0 && !meanwhile) error = flushed();
    if (error == 0 && meanwhile) {
      auto waiting = std::async(std::launch::async, flushed);
      meanwhile(temporary);
      error = waiting.get();
    }
    if (error != 0) raise_file_error(file, error, "cannot flush the file to the disk");
    require_inputs_kept({{file, file.string()}});
    if (::rename(temporary.c_str(), file.c_str()) != 0)
      raise_file_error(file, errno, "cannot give the file its final name");
  } catch (...) {
    ::unlink(temporary.c_str());
    throw;
  }
  flush_folder(file.parent_path());
}

}  // namespace

void publish(const fs::path& file) { publish_and(file, {}); }

std::string publish_hashed(const fs::path& file) {
  std::string hash;
  publish_and(file, [&](const fs::path& temporary) { hash = hash_of_file(temporary); });
  return hash;
}

NewFile::NewFile(fs::path file, std::string failure)
    : file_(std::move(file)), failure_(std::move(failure)), fd_(open_new(temporary_name(file_))) {
  if (fd_ < 0) fail();
}

NewFile::~NewFile() {
  if (fd_ < 0) return;
  ::close(fd_);
  ::unlink(temporary_name(file_).c_str());
}

void NewFile::fail() const { raise_file_error(file_, errno, failure_); }

void NewFile::write(const void* data, std::size_t bytes) {
  if (!write_all(fd_, {static_cast<const char*>(data), bytes})) fail();
}

void NewFile::publish() {
  require_inputs_kept({{file_, file_.string()}});
  const fs::path temporary = temporary_name(file_);
  if (flush(fd_) != 0 || ::rename(temporary.c_str(), file_.c_str()) != 0) fail();
  if (::close(std::exchange(fd_, -1)) != 0 && errno != EINTR) fail();  // after EINTR the descriptor is closed
  flush_folder(file_.parent_path());
}

void write_text(const fs::path& file, std::string_view text) {
  NewFile f(file);
  f.write(text.data(), text.size());
  f.publish();
}

std::string read_text(const fs::path& file) {
  std::string text;
  read_pieces(file, [&](std::string_view piece) { text += piece; });
  return text;
}

std::string hash_of_file(const fs::path& file) {
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                              XXH3_freeState);
  XXH3_64bits_reset(state.get());
  read_pieces(file,
              [&](std::string_view piece) { XXH3_64bits_update(state.get(), piece.data(), piece.size()); });
  return hex(XXH3_64bits_digest(state.get()));
}

std::string hex(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

}  // namespace swingbank
