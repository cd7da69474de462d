#include "base/problem.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace swingbank {

namespace {

constexpr std::size_t kLongestShown = 1000;  ///< length above which a text is cut [bytes]

unsigned at(std::string_view text, std::size_t i) { return static_cast<unsigned char>(text[i]); }

/// Returns the length of the UTF-8 character at i [bytes]; 0 if there is none.
std::size_t character(std::string_view text, std::size_t i) {
  const unsigned first = at(text, i);
  const std::size_t n = first < 0x80       ? 1
                        : first >> 5 == 6  ? 2
                        : first >> 4 == 14 ? 3
                        : first >> 3 == 30 ? 4
                                           : 0;
  if (n == 0 || i + n > text.size()) return 0;
  for (std::size_t k = 1; k < n; ++k)
    if (at(text, i + k) >> 6 != 2) return 0;
  return n;
}

/// Returns whether a character is a control character: below U+0020, DEL, or U+0080 to U+009F.
bool is_control(std::string_view character) {
  const unsigned first = at(character, 0);
  return first < 0x20 || first == 0x7F || (first == 0xC2 && at(character, 1) < 0xA0);
}

}  // namespace

std::string shown(std::string_view text) {
  std::string out;
  std::size_t i = 0;
  while (i < std::min(text.size(), kLongestShown)) {
    const std::size_t n = character(text, i);
    const std::string_view one = text.substr(i, std::max<std::size_t>(n, 1));
    if (n > 0 && (one == "\n" || !is_control(one)))
      out += one;
    else
      for (std::size_t k = 0; k < one.size(); ++k) out += fmt::format("\\x{:02x}", at(one, k));
    i += one.size();
  }
  if (i < text.size()) out += fmt::format(" ... ({} bytes more)", text.size() - i);
  return out;
}

}  // namespace swingbank
