#pragma once
// Input files given by the user. The error for an unreadable file names the folder that was searched and
// Swingbank's example of that name, if there is one. An example is never read in place of the named file.
#include <filesystem>
#include <string>

#include "base/problem.hpp"

namespace swingbank {

/// Returns the folder of this program's example configs: `<prefix>/share/swingbank/configs` of an
/// installation, or configs/ of the source tree for a build folder. Empty path if there is none.
std::filesystem::path example_configs();

/// Returns the problem "<what> at <file> (<why>): <remedy>" for a file that cannot be read. For a relative
/// path that does not exist, the remedy names the example of that path in `examples` instead, if there is
/// one.
Problem unreadable(const std::filesystem::path& file, const std::string& what, const std::string& remedy,
                   const std::filesystem::path& examples = example_configs());

/// Returns the content of a file. Throws InputError with the problem of `unreadable` if the file cannot be
/// read or is empty.
std::string read_input(const std::filesystem::path& file, const std::string& what, const std::string& remedy);

}  // namespace swingbank
