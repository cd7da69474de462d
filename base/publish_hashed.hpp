#pragma once
// Atomic publication of a file (durable.hpp) and computation of its hash while the disk flushes.
#include <filesystem>
#include <string>

namespace swingbank {

/// Publishes a file as `publish` (base/durable.hpp) does and returns the hash of its bytes as `hash_of_file`
/// does. On failure, removes the temporary file and throws InputError.
std::string publish_hashed(const std::filesystem::path& file);

}  // namespace swingbank
