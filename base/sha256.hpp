#pragma once
// SHA-256 of a file, as audits ask for it.
#include <filesystem>
#include <string>

namespace swingbank {

/// 64 hexadecimal digits; empty where the file cannot be read.
std::string sha256_of_file(const std::filesystem::path& file);

}  // namespace swingbank
