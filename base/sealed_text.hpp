#pragma once
// JSON objects with a checksum: the last entry, "sum", is XXH3-64 over all bytes before it.
#include <string>
#include <string_view>

namespace swingbank {

/// Returns a JSON object (text with at least one entry) with its checksum appended, and a line feed.
std::string sealed_text(std::string_view object);
/// Returns whether the checksum of `text` is correct; the line feed may be missing.
bool is_sealed(std::string_view text);

}  // namespace swingbank
