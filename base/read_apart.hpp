#pragma once
// Reading of untrusted files in a separate process, because HDF5 1.10 and libmatio crash on some damaged
// files. The process runs swingbank-read-hdf5 from the folder of this program, and returns the content
// through a pipe.
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace swingbank {

/// Returns the output of the reader for the arguments `kind`, `file` and `words`. Throws InputError with the
/// problems that the reader found. A crash or a timeout (300 s plus 1 s per 5 MB) of the reader is also a
/// problem. Safe to call from several threads and after MPI_Init, because the child process runs only that
/// program.
std::string read_apart(const std::string& kind, const std::filesystem::path& file,
                       const std::vector<std::string>& words);

/// Main function of the reader: prints the result of `work`, or the problems of its InputError, to standard
/// output. Returns the exit code. Limits the processor time to 30 s, or SWINGBANK_READER_SECONDS from the
/// environment, plus 1 s per 5 MB of the file.
int reply_apart(const std::filesystem::path& file, const std::function<std::string()>& work);

}  // namespace swingbank
