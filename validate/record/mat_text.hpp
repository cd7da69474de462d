#pragma once
// A MATLAB file (v4, v5 and v7.3) as text in columns. Its library, and HDF5 below it, may crash on a damaged
// file: base/read_apart has it done by a process of its own.
#include <filesystem>
#include <string>

namespace swingbank::validate::record {

/// The kind of file ("MATLAB 7.3", "MATLAB") in the first line, then names and values between tabs. `time` is
/// how the user names the times; empty: what is called so. Throws InputError, also where the file is cut
/// short.
std::string mat_text(const std::filesystem::path& file, const std::string& time);

}  // namespace swingbank::validate::record
