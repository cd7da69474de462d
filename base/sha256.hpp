#pragma once
// SHA-256, as audits ask for it: sha256sum gives the same.
#include <filesystem>
#include <string>
#include <string_view>

namespace swingbank {

/// 64 hexadecimal digits.
std::string sha256(std::string_view bytes);
/// The same; empty where the file cannot be read.
std::string sha256_of_file(const std::filesystem::path& file);

}  // namespace swingbank
