#pragma once
// Conversion of a MATLAB file (v4, v5 and v7.3) to text columns. The MATLAB and HDF5 libraries may crash on a
// damaged file, so base/read_apart runs the conversion in a separate process.
#include <filesystem>
#include <string>

namespace swingbank::validate::record {

/// Returns the kind of file ("MATLAB 7.3", "MATLAB") in the first line, then names and values separated by
/// tabs. `time` is the user's name of the time variable; if empty, it is found by its name. Throws
/// InputError, also for truncated files.
std::string mat_text(const std::filesystem::path& file, const std::string& time);

}  // namespace swingbank::validate::record
