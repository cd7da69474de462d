#pragma once
// Conversion of a MATLAB file (v4, v5 and v7.3) to text columns. The MATLAB and HDF5 libraries may crash on a
// damaged file, so base/read_apart runs the conversion in a separate process.
#include <filesystem>
#include <string>

namespace swingbank::validate::record {

/// Returns a text: the kind of file ("MATLAB 7.3", "MATLAB") in the first line, then names and values
/// separated by tabs. `time` is the name of the time variable given by the user; if empty, the variable is
/// recognised by its name. Throws InputError, also for truncated files.
std::string mat_text(const std::filesystem::path& file, const std::string& time);

}  // namespace swingbank::validate::record
