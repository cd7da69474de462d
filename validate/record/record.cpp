#include "validate/record/record.hpp"

#include <xxhash.h>

#include <algorithm>
#include <cctype>

#include "base/input_file.hpp"
#include "validate/record/formats.hpp"

namespace swingbank::validate::record {
namespace {

/// "run.h5#G2": the terminal behind the last '#', unless that is part of the file's name.
std::filesystem::path split_terminal(const std::filesystem::path& file, ReadOptions& options) {
  const std::string text = file.string();
  const auto at = text.rfind('#');
  if (at == std::string::npos || at == 0 || std::filesystem::exists(file)) return file;
  options.terminal = text.substr(at + 1);
  return text.substr(0, at);
}

std::string extension(const std::filesystem::path& file) {
  std::string e = file.extension().string();
  std::ranges::transform(e, e.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return e;
}

/// The other file of a pair, in the case the first one is written in, or the other.
std::filesystem::path partner(std::filesystem::path file, const char* lower, const char* upper) {
  const std::string e = file.extension().string();
  const bool capitals = e.size() > 1 && std::isupper(static_cast<unsigned char>(e[1])) != 0;
  const std::filesystem::path same = file.replace_extension(capitals ? upper : lower);
  if (std::filesystem::exists(same)) return same;
  const std::filesystem::path other = file.replace_extension(capitals ? lower : upper);
  return std::filesystem::exists(other) ? other : same;
}

Record read_comtrade(const std::filesystem::path& file, const RecordBase& base, const ReadOptions& options) {
  const std::string e = extension(file), name = file.filename().string();
  std::string bytes;
  Record record;
  if (e == ".cff") {
    bytes = read_bytes(file);
    record = record_of_comtrade(parse_cff(bytes, file.string()), name, base, options);
  } else {
    const auto cfg = e == ".cfg" ? file : partner(file, ".cfg", ".CFG");
    const auto dat = e == ".dat" ? file : partner(file, ".dat", ".DAT");
    bytes = read_bytes(cfg);
    const std::size_t split = bytes.size();
    bytes += read_bytes(dat);
    const std::string_view all = bytes;
    record = record_of_comtrade(
        parse_comtrade(all.substr(0, split), all.substr(split), cfg.string(), dat.string()), name, base,
        options);
  }
  record.hash = XXH64(bytes.data(), bytes.size(), 0);
  return record;
}

}  // namespace

std::string read_bytes(const std::filesystem::path& file) {
  return read_input(file, "no readable record", "give the path of a record");
}

Record read_record(const std::filesystem::path& named, const RecordBase& base, const ReadOptions& given) {
  ReadOptions options = given;
  const std::filesystem::path file = split_terminal(named, options);
  const std::string e = extension(file);
  const bool comtrade = e == ".cfg" || e == ".dat" || e == ".cff";
  Record record = comtrade                     ? read_comtrade(file, base, options)
                  : e == ".h5" || e == ".hdf5" ? read_hdf5_record(file, base, options)
                                               : parse_record(read_bytes(file), file.string(), base, options);
  record.name = named.filename().string();  // with the terminal, if one was named: two of a file differ
  return record;
}

}  // namespace swingbank::validate::record
