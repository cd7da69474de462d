#include "validate/record/source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace swingbank::validate::record {
namespace {

std::string extension(const std::filesystem::path& file) {
  std::string e = file.extension().string();
  std::ranges::transform(e, e.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return e;
}

/// Returns the other file of a pair, preferably with an extension in the same case.
std::filesystem::path partner(std::filesystem::path file, const char* lower, const char* upper) {
  const std::string e = file.extension().string();
  const bool capitals = e.size() > 1 && std::isupper(static_cast<unsigned char>(e[1])) != 0;
  const std::filesystem::path same = file.replace_extension(capitals ? upper : lower);
  if (std::filesystem::exists(same)) return same;
  const std::filesystem::path other = file.replace_extension(capitals ? lower : upper);
  return std::filesystem::exists(other) ? other : same;
}

/// Returns the file of "file#terminal"; the whole name if it has no '#'.
std::filesystem::path before_terminal(const std::filesystem::path& named) {
  const std::string text = named.string();
  return text.substr(0, text.rfind('#'));
}

/// Splits "event.plb+meter.csv" into the files of one event, unless it is one file's name. If none of the
/// files exists, the name is not split either, so that the message about it has the whole name.
std::vector<std::filesystem::path> parts_of(const std::filesystem::path& named) {
  if (std::filesystem::exists(named)) return {named};
  std::vector<std::filesystem::path> parts;
  const std::string text = named.string();
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find('+', at), text.size());
    if (end > at) parts.emplace_back(text.substr(at, end - at));
    at = end + 1;
  }
  const auto exists = [](const std::filesystem::path& part) {
    return std::filesystem::exists(part) || std::filesystem::exists(before_terminal(part));
  };
  if (std::ranges::none_of(parts, exists)) return {named};
  return parts;
}

/// Returns the .inf of a PSCAD output file "case_01.out"; empty if the name has no number or no .inf exists.
std::filesystem::path inf_of(const std::filesystem::path& out) {
  const std::string stem = out.stem().string();
  const auto digits = stem.find_last_not_of("0123456789");
  if (digits == std::string::npos || stem[digits] != '_' || digits + 1 == stem.size()) return {};
  const auto inf =
      partner(out.parent_path() / (stem.substr(0, digits) + out.extension().string()), ".inf", ".INF");
  return std::filesystem::exists(inf) ? inf : std::filesystem::path();
}

SourceFile source_file(const std::filesystem::path& named) {
  using Format = SourceFile::Format;
  SourceFile file;
  file.path = named;
  file.name = named.filename().string();
  const std::filesystem::path before = before_terminal(named);
  // Otherwise '#' is part of the file's name, or neither file exists.
  if (!std::filesystem::exists(named) && std::filesystem::exists(before)) {
    file.path = before;
    file.terminal = named.string().substr(before.string().size() + 1);
  }
  const std::string e = extension(file.path);
  if (e == ".cfg" || e == ".dat") {
    file.config = e == ".cfg" ? file.path : partner(file.path, ".cfg", ".CFG");
    file.data = e == ".dat" ? file.path : partner(file.path, ".dat", ".DAT");
  }
  if (e == ".inf") file.config = file.path;
  if (e == ".out") file.config = inf_of(file.path);
  const bool pscad = (e == ".inf" || e == ".out") && !file.config.empty();
  file.format = pscad                                       ? Format::pscad
                : e == ".cfg" || e == ".dat" || e == ".cff" ? Format::comtrade
                : e == ".h5" || e == ".hdf5"                ? Format::hdf5
                : e == ".mat"                               ? Format::matlab
                                                            : Format::text;
  return file;
}

}  // namespace

std::filesystem::path pscad_part(const std::filesystem::path& inf, std::size_t number) {
  const bool capitals = inf.extension() == ".INF";
  return inf.parent_path() /
         fmt::format("{}_{:02}{}", inf.stem().string(), number, capitals ? ".OUT" : ".out");
}

std::vector<std::filesystem::path> SourceFile::all_files() const {
  if (config.empty()) return {path};
  std::vector<std::filesystem::path> files = {config};
  if (!data.empty()) files.push_back(data);
  if (format != Format::pscad) return files;
  for (std::size_t n = 1; std::filesystem::exists(pscad_part(config, n)); ++n)
    files.push_back(pscad_part(config, n));
  return files;
}

Source::Source(const std::filesystem::path& named) : path(named) {
  std::vector<std::filesystem::path> parts = parts_of(named);
  if (parts.size() < 2) parts = {named};
  for (const auto& part : parts) {
    files.push_back(source_file(part));
    name += (name.empty() ? "" : "+") + files.back().name;
  }
}

bool Source::is_named(const std::string& record) const {
  if (files.size() > 1) return record == name || record == path.string();
  return record == before_terminal(path).filename().string() || record == path.filename().string();
}

}  // namespace swingbank::validate::record
