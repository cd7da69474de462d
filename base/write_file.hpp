#pragma once
// Atomic writing of result files.
#include <filesystem>
#include <string>
#include <string_view>

namespace swingbank {

/// Creates the folder if needed, and writes the file atomically. On failure (no permission, full disk),
/// throws InputError and leaves an existing file unchanged.
void write_file(const std::filesystem::path& file, std::string_view content);

}  // namespace swingbank
