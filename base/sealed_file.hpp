#pragma once
// Files of a JSON header and raw single-precision arrays with a checksum. They are written atomically: if the
// program is killed, the last valid file remains.
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

namespace swingbank {

/// Kind of a file: its name in messages, its first bytes, and the remedy if it is damaged.
struct SealedKind {
  const char *what, *magic, *remedy;  ///< name in messages; first bytes; remedy
};

/// Exception for file content that cannot be used. The callbacks of `read_sealed` may throw it.
struct Unusable {
  std::string why;  ///< reason for the message
};

/// Writes a file atomically. Throws InputError and leaves no temporary file if it cannot be written.
void write_sealed(const SealedKind& kind, const std::filesystem::path& file, const nlohmann::json& header,
                  const std::vector<std::span<const float>>& arrays);

/// Returns the destination of array i, which has `size` values. May throw Unusable.
using PlaceArray = std::function<std::span<float>(std::size_t i, std::size_t size)>;
/// Verifies the checksum, calls `start` with the header and the number of arrays, then reads each array into
/// the memory that `place` returns. `start` may throw Unusable. Returns false if there is no such file.
/// Throws InputError if the file is damaged or Unusable was thrown.
bool read_sealed(const SealedKind& kind, const std::filesystem::path& file,
                 const std::function<void(const nlohmann::json&, std::size_t arrays)>& start,
                 const PlaceArray& place);

}  // namespace swingbank
