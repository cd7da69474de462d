#pragma once
// Encoding of text files.
#include <string>
#include <string_view>
#include <vector>

namespace swingbank {

/// Returns the text as UTF-8. Other encodings are interpreted as Windows-1251 if letters beyond ASCII are
/// mostly adjacent, as in Cyrillic words, otherwise as Windows-1252. `notes` reports the choice.
std::string as_utf8(std::string_view text, std::vector<std::string>& notes);

}  // namespace swingbank
