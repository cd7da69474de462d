#pragma once
// Files that a library may crash on, read by a program of its own: HDF5 1.10 and libmatio do on damaged ones.
// The program is swingbank-read-hdf5, beside this one; what it read comes back through a pipe.
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace swingbank {

/// What the program answers to `kind`, `file` and `words`. Throws InputError with the problems that it found,
/// or one that says how it ended: a crash, or no end within five minutes. May be called from several threads,
/// and after MPI_Init: no copy of this process runs anything but that program.
std::string read_apart(const std::string& kind, const std::filesystem::path& file,
                       const std::vector<std::string>& words);

/// The other end: prints what `work` makes of the file, or its InputError's problems, to stdout. The exit
/// code. The process is ended after 30 s of processor time and one more for each 5 MB;
/// SWINGBANK_READER_SECONDS: instead of 30.
int answer_apart(const std::filesystem::path& file, const std::function<std::string()>& work);

}  // namespace swingbank
