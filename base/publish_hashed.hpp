#pragma once
// A file's hash taken while the disk is flushed, which leaves the processor free.
#include <filesystem>
#include <string>

namespace swingbank {

/// `publish` of base/durable.hpp, and the hash of the file's bytes as hash_of_file has it. Throws InputError;
/// removes the temporary file then.
std::string publish_hashed(const std::filesystem::path& file);

}  // namespace swingbank
