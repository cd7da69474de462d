#pragma once
// SHA-256 hashes as sha256sum prints them, for the provenance of reports.
#include <filesystem>
#include <string>
#include <string_view>

namespace swingbank {

/// Returns the SHA-256 hash, 64 hexadecimal digits.
std::string sha256(std::string_view bytes);
/// Returns the hash of a file's bytes; empty if the file cannot be read.
std::string sha256_of_file(const std::filesystem::path& file);

}  // namespace swingbank
