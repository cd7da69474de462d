#pragma once
// Files that a user names. One that cannot be read is told with the place where it was looked for, and with
// Swingbank's own example of that name, if there is one: examples are never read in place of what was named.
#include <filesystem>
#include <string>

#include "base/problem.hpp"

namespace swingbank {

/// Folder of the example configs that belong to this program: <prefix>/share/swingbank/configs of an
/// installation, configs/ of the source tree in a build folder. Empty path if there is none.
std::filesystem::path example_configs();

/// Why `file` cannot be read, as "<what> at <file> (<why>): <remedy>". For a relative path that does not
/// exist, the remedy names the example of that path in `examples` instead, if there is one.
Problem unreadable(const std::filesystem::path& file, const std::string& what, const std::string& remedy,
                   const std::filesystem::path& examples = example_configs());

/// Bytes of a file. Throws InputError as unreadable() says it if it cannot be read or is empty.
std::string read_input(const std::filesystem::path& file, const std::string& what, const std::string& remedy);

}  // namespace swingbank
