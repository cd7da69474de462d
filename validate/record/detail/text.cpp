#include "validate/record/detail/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <utility>

#include "base/problem.hpp"

namespace swingbank::validate::record {
namespace {

bool ends_with(const std::string& name, std::string_view ending) {
  if (name.size() < ending.size()) return false;
  return std::ranges::equal(std::string_view(name).substr(name.size() - ending.size()), ending,
                            [](unsigned char a, char b) { return std::tolower(a) == b; });
}

/// Returns whether the name is that of a PSCAD output file, "case_01.out".
bool is_part_of_pscad(std::string_view name) {
  if (!name.ends_with(".out")) return false;
  name.remove_suffix(4);
  const auto at = name.find_last_not_of("0123456789");
  return at != std::string_view::npos && name[at] == '_' && at + 1 < name.size();
}

[[noreturn]] void refuse(const std::string& what, const std::string& name, const std::string& why,
                         const std::string& remedy) {
  throw InputError({what, name, why, remedy});
}

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

std::string_view trimmed(std::string_view text, std::string_view blank) {
  const auto first = text.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

std::string_view take_line(std::string_view& text) {
  const auto end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

void refuse_binary(std::string_view bytes, const std::string& name) {
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF"))
    refuse("a file in UTF-16", name, "spreadsheet programs and PowerShell write it as \"Unicode text\"",
           "save it as CSV in UTF-8 (PowerShell: Out-File -Encoding utf8)");
  if (bytes.starts_with("MATLAB 5.0") || bytes.starts_with("MATLAB 7.3"))
    refuse("a MATLAB file", name, "its name does not end in .mat", "rename it");
  if (is_part_of_pscad(name) && bytes.substr(0, 4096).find('\0') == std::string_view::npos)
    refuse("an output file of PSCAD without its .inf", name, "the .inf names the channels of the .out files",
           "copy NAME.inf beside NAME_01.out, and give either of them");
  if (ends_with(name, ".out") || ends_with(name, ".outx"))
    refuse("an output file of PSS/E", name, "its format is not public",
           "export it as CSV in PSS/E's Python: dyntools.CHNF('run.out').csvout(outfile='run.csv')");
  if (ends_with(name, ".toml") || bytes.substr(0, 65536).find("\n[plant]") != std::string_view::npos ||
      bytes.starts_with("[plant]"))
    refuse("a plant file", name, "a record is expected here",
           "give it as --model, and the record as --records");
  if (ends_with(name, ".raw") || ends_with(name, ".dyr"))
    refuse("a case of PSS/E", name, "a record is expected here",
           "give the record as --records; swingbank plant converts the case to a plant file");
  // A spreadsheet is a zip file that contains xl/ (Excel) or begins with its media type (LibreOffice).
  const std::string_view begin = bytes.substr(0, 4096);
  const bool sheet = begin.find("xl/") != std::string_view::npos ||
                     begin.find("[Content_Types].xml") != std::string_view::npos ||
                     begin.find("opendocument") != std::string_view::npos || ends_with(name, ".xlsx") ||
                     ends_with(name, ".ods");
  const std::pair<std::string_view, const char*> archives[] = {
      {"PK\x03\x04", "a zip archive"}, {"\x1F\x8B", "a gzip archive"},   {"7z\xBC\xAF", "a 7z archive"},
      {"BZh", "a bzip2 archive"},      {"\xFD\x37zXZ", "an xz archive"}, {"Rar!", "a rar archive"}};
  for (const auto& [magic, what] : archives)
    if (bytes.starts_with(magic) && !sheet)
      refuse(what, name, "archives are not unpacked", "unpack it and give the record in it");
  if (bytes.starts_with("PK\x03\x04") || bytes.starts_with("\xD0\xCF\x11\xE0") || ends_with(name, ".xlsx"))
    refuse("a spreadsheet", name, "only text in columns is read", "save the sheet as CSV (UTF-8)");
  if (ends_with(name, ".psout"))
    refuse(
        "a .psout file of PSCAD", name, "its format is not public",
        "let PSCAD write .inf and .out (Project Settings, Runtime), or export it as CSV: in the graph, Copy "
        "Data to File; or with the Python package mhi-psout");
  if (bytes.starts_with("\x89HDF"))
    refuse("an HDF5 file", name, "its name does not end in .h5", "rename it, if swingbank simulate wrote it");
  const std::string_view head = bytes.substr(0, 4096);
  const auto nothing = std::ranges::count(head, '\0');
  if (4 * static_cast<std::size_t>(nothing) > head.size() && head.size() > 8)
    refuse("a file in UTF-16, or no text at all", name, "more than a quarter of the bytes are zero",
           "save it as CSV in UTF-8");
  if (nothing > 0)
    refuse("a binary file", name, "it contains zero bytes",
           "give CSV, COMTRADE (.cfg or .dat of a pair, .cff), PSCAD output (.inf) or HDF5 (.h5)");
}

std::string as_utf8(std::string_view text, std::vector<std::string>& notes) {
  if (is_utf8(text)) return std::string(text);
  const bool cyrillic = is_cyrillic(text);
  std::string out;
  for (const char c : text) append(out, (cyrillic ? from_1251 : from_1252)(static_cast<unsigned char>(c)));
  notes.push_back(fmt::format("The text is not UTF-8: it was read as Windows-{}.", cyrillic ? 1251 : 1252));
  return out;
}

}  // namespace swingbank::validate::record
