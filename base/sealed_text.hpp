#pragma once
// JSON objects that tell when a byte of them has changed: their last entry is "sum", XXH3-64 over all before
// it.
#include <string>
#include <string_view>

namespace swingbank {

/// `object`: the text of a JSON object with at least one entry. The same with its sum, and a line feed.
std::string sealed_text(std::string_view object);
/// Whether it is what sealed_text returned, with or without the line feed.
bool is_sealed(std::string_view text);

}  // namespace swingbank
