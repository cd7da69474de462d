#include "validate/record/detail/text.hpp"

#include <algorithm>
#include <cctype>
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

}  // namespace swingbank::validate::record
