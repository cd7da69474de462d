#include "base/encoding.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>

namespace swingbank {
namespace {

/// Returns the length of the UTF-8 sequence at `at`; 0 if invalid.
std::size_t sequence(std::string_view s, std::size_t at) {
  const auto c = static_cast<unsigned char>(s[at]);
  const std::size_t n = c < 0x80                ? 1
                        : c >= 0xC2 && c < 0xE0 ? 2
                        : c >= 0xE0 && c < 0xF0 ? 3
                        : c >= 0xF0 && c < 0xF5 ? 4
                                                : 0;
  if (n == 0 || at + n > s.size()) return 0;
  for (std::size_t k = 1; k < n; ++k)
    if ((static_cast<unsigned char>(s[at + k]) & 0xC0) != 0x80) return 0;
  return n;
}
bool is_utf8(std::string_view s) {
  for (std::size_t at = 0; at < s.size();) {
    const std::size_t n = sequence(s, at);
    if (n == 0) return false;
    at += n;
  }
  return true;
}

void append(std::string& out, std::uint32_t c) {
  if (c < 0x80) {
    out += static_cast<char>(c);
  } else if (c < 0x800) {
    out += static_cast<char>(0xC0 | (c >> 6));
    out += static_cast<char>(0x80 | (c & 0x3F));
  } else {
    out += static_cast<char>(0xE0 | (c >> 12));
    out += static_cast<char>(0x80 | ((c >> 6) & 0x3F));
    out += static_cast<char>(0x80 | (c & 0x3F));
  }
}

/// Characters 0x80 .. 0xBF of Windows-1251; 0xC0 .. 0xFF are the letters from U+0410 on.
constexpr std::array<std::uint16_t, 64> k1251 = {
    0x402, 0x403,  0x201A, 0x453, 0x201E, 0x2026, 0x2020, 0x2021, 0x20AC, 0x2030, 0x409,  0x2039, 0x40A,
    0x40C, 0x40B,  0x40F,  0x452, 0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014, 0xFFFD, 0x2122,
    0x459, 0x203A, 0x45A,  0x45C, 0x45B,  0x45F,  0xA0,   0x40E,  0x45E,  0x408,  0xA4,   0x490,  0xA6,
    0xA7,  0x401,  0xA9,   0x404, 0xAB,   0xAC,   0xAD,   0xAE,   0x407,  0xB0,   0xB1,   0x406,  0x456,
    0x491, 0xB5,   0xB6,   0xB7,  0x451,  0x2116, 0x454,  0xBB,   0x458,  0x405,  0x455,  0x457};
/// Characters 0x80 .. 0x9F of Windows-1252; all others equal Unicode.
constexpr std::array<std::uint16_t, 32> k1252 = {
    0x20AC, 0xFFFD, 0x201A, 0x192,  0x201E, 0x2026, 0x2020, 0x2021, 0x2C6,  0x2030, 0x160,
    0x2039, 0x152,  0xFFFD, 0x17D,  0xFFFD, 0xFFFD, 0x2018, 0x2019, 0x201C, 0x201D, 0x2022,
    0x2013, 0x2014, 0x2DC,  0x2122, 0x161,  0x203A, 0x153,  0xFFFD, 0x17E,  0x178};

std::uint32_t from_1251(unsigned char c) {
  return c < 0x80 ? c : c < 0xC0 ? k1251[c - 0x80U] : 0x410U + (c - 0xC0U);
}
std::uint32_t from_1252(unsigned char c) { return c >= 0x80 && c < 0xA0 ? k1252[c - 0x80U] : c; }

/// Returns whether bytes from 0xC0 on are mostly adjacent. Such bytes are adjacent in Cyrillic text, but not
/// in western text.
bool is_cyrillic(std::string_view s) {
  std::size_t letters = 0, beside = 0;
  for (std::size_t k = 0; k < s.size(); ++k) {
    const auto high = [&](std::size_t i) { return i < s.size() && static_cast<unsigned char>(s[i]) >= 0xC0; };
    if (!high(k)) continue;
    ++letters;
    beside += high(k + 1) || (k > 0 && high(k - 1)) ? 1 : 0;
  }
  return 2 * beside > letters;
}

}  // namespace

std::string as_utf8(std::string_view text, std::vector<std::string>& notes) {
  if (is_utf8(text)) return std::string(text);
  const bool cyrillic = is_cyrillic(text);
  std::string out;
  for (const char c : text) append(out, (cyrillic ? from_1251 : from_1252)(static_cast<unsigned char>(c)));
  notes.push_back(fmt::format("The text is not UTF-8: it was read as Windows-{}.", cyrillic ? 1251 : 1252));
  return out;
}

}  // namespace swingbank
