#pragma once
// Atomic writing of files: temporary name, write, fsync, rename, fsync of the folder. An existing file under
// the temporary name is removed and never opened, so a symbolic link of that name is not followed.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace swingbank {

/// Returns the temporary name of a file while it is written: ".<name>.part" in the same folder. Code that
/// writes to it by other means (HDF5, MPI-IO) creates it with `reserve`.
std::filesystem::path temporary_name(const std::filesystem::path& file);
/// Creates a folder and its parents. Throws InputError with the folder and the system's error text.
void make_folder(const std::filesystem::path& folder);
/// Creates the temporary file anew and allocates `bytes` of disk space. On failure, removes the temporary
/// file and throws InputError with the system's error text (disk full, no permission). HDF5 and MPI-IO would
/// not report that text.
void reserve(const std::filesystem::path& file, std::uint64_t bytes);
/// Flushes the temporary file to the disk and renames it to its final name. On failure, removes the temporary
/// file and throws InputError.
void publish(const std::filesystem::path& file);
/// Flushes the data that this machine has written to the temporary file. Throws InputError on failure.
void flush_temporary(const std::filesystem::path& file);
/// Flushes the entries of a folder, so that a rename in it survives a power failure. Throws InputError on
/// failure.
void flush_folder(const std::filesystem::path& folder);
/// File that is written piece by piece. The destructor removes it unless it was published.
class NewFile {
 public:
  /// Creates the temporary file. All members throw InputError on failure. If the file cannot be written, the
  /// message begins with `failure`.
  explicit NewFile(std::filesystem::path file, std::string failure = "cannot write the file");
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  /// Appends bytes.
  void write(const void* data, std::size_t bytes);
  /// Flushes the file and renames it to its final name.
  void publish();

 private:
  [[noreturn]] void fail() const;
  std::filesystem::path file_;
  std::string failure_;
  int fd_ = -1;
};
/// Writes a text file atomically. Throws InputError on failure.
void write_text(const std::filesystem::path& file, std::string_view text);
/// Returns the content of a file. Throws InputError if it cannot be read.
std::string read_text(const std::filesystem::path& file);
/// Throws InputError "<what> at <file> (<text of errno value `error`>): <remedy>".
[[noreturn]] void raise_file_error(const std::filesystem::path& file, int error, const std::string& what);
/// Returns the XXH3-64 hash of a file's bytes, 16 hex digits. Throws InputError if the file cannot be read.
std::string hash_of_file(const std::filesystem::path& file);
/// Returns a number as 16 lower-case hex digits.
std::string hex(std::uint64_t value);

}  // namespace swingbank
