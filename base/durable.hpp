#pragma once
// Files that exist whole or not at all: temporary name, write, fsync, rename, fsync of the folder. What
// stands under the temporary name is removed, never opened, so that a link there leads nowhere.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace swingbank {

/// The name a file carries while it is written: ".<name>.part" beside it. Whoever else writes there makes the
/// file with `reserve`.
std::filesystem::path temporary_name(const std::filesystem::path& file);
/// Creates a folder and its parents. Throws InputError naming the folder and the system's reason.
void make_folder(const std::filesystem::path& folder);
/// Creates the temporary file anew and asks the system for `bytes` of space. Throws InputError with the
/// system's reason (disk full, no permission), which HDF5 and MPI-IO do not pass on; removes the temporary
/// then.
void reserve(const std::filesystem::path& file, std::uint64_t bytes);
/// Flushes the temporary file to the disk and gives it its final name. Throws InputError; removes the
/// temporary then.
void publish(const std::filesystem::path& file);
/// Flushes what this machine has written of the temporary file. Throws InputError.
void flush_temporary(const std::filesystem::path& file);
void flush_folder(const std::filesystem::path& folder);
/// A file that is written piece by piece. Where it is not published, nothing of it stays.
class NewFile {
 public:
  /// `failure` is said of whatever cannot be written. Throws InputError, as all others do.
  explicit NewFile(std::filesystem::path file, std::string failure = "cannot write the file");
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  void write(const void* data, std::size_t bytes);
  /// Flushes the file and gives it its final name.
  void publish();

 private:
  [[noreturn]] void fail() const;
  std::filesystem::path file_;
  std::string failure_;
  int fd_ = -1;
};
/// Writes text whole or not at all.
void write_text(const std::filesystem::path& file, std::string_view text);
/// Throws InputError if the file cannot be read.
std::string read_text(const std::filesystem::path& file);
/// Throws InputError: "<what> at <file> (<the system's reason>): <remedy>".
[[noreturn]] void raise_file_error(const std::filesystem::path& file, int error, const std::string& what);
/// XXH3-64 over the bytes of a file, 16 hex digits. Throws InputError.
std::string hash_of_file(const std::filesystem::path& file);
/// 16 lower-case hex digits.
std::string hex(std::uint64_t value);

}  // namespace swingbank
