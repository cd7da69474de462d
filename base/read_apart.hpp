#pragma once
// Reading of untrusted files in a separate process, because HDF5 1.10 and libmatio crash on some damaged
// files. The program is swingbank-read-hdf5 in this program's folder; it returns the content through a pipe.
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace swingbank {

/// Returns the output of the reader for the arguments `kind`, `file` and `words`. Throws InputError with the
/// problems that the reader found, or with its failure: a crash, or a timeout (300 s and 1 s more for each 5
/// MB). Safe to call from several threads and after MPI_Init, because the child process runs nothing but that
/// program.
std::string read_apart(const std::string& kind, const std::filesystem::path& file,
                       const std::vector<std::string>& words);

/// Reader's side: prints the result of `work` for the file, or the problems of its InputError, to standard
/// output. Returns the exit code. Limits the process to 30 s of processor time (environment variable
/// SWINGBANK_READER_SECONDS: another limit) and 1 s more for each 5 MB.
int reply_apart(const std::filesystem::path& file, const std::function<std::string()>& work);

}  // namespace swingbank
