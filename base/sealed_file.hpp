#pragma once
// A JSON header and raw single-precision arrays in one file, sealed with a checksum. Written under a
// temporary name, flushed and renamed, so that the last good file survives a kill at any moment.
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

namespace swingbank {

/// What a file is called in messages, its first bytes, and what to do when it is damaged.
struct SealedKind {
  const char *what, *magic, *remedy;
};

/// Thrown by whoever takes a file's content: why it cannot be used.
struct Unusable {
  std::string why;
};

/// Throws InputError if the file cannot be written; nothing is left behind then.
void write_sealed(const SealedKind& kind, const std::filesystem::path& file, const nlohmann::json& header,
                  const std::vector<std::span<const float>>& arrays);

/// Gives the place for array i of `size` values. May throw Unusable.
using PlaceArray = std::function<std::span<float>(std::size_t i, std::size_t size)>;
/// Reads into the places given, after `start` has seen the header and the number of arrays (which may throw
/// Unusable too). False if there is no such file. Throws InputError if the file is damaged or refused.
bool read_sealed(const SealedKind& kind, const std::filesystem::path& file,
                 const std::function<void(const nlohmann::json&, std::size_t arrays)>& start,
                 const PlaceArray& place);

}  // namespace swingbank
