#include "validate/record.hpp"

#include <fstream>
#include <sstream>

namespace swingbank::validate {
namespace {

std::string read_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  if (!in || !(text << in.rdbuf()))
    throw InputError({"no readable record", file.string(), "the file cannot be opened or is empty",
                      "give the path of a record"});
  return std::move(text).str();
}

/// "run.h5#G2": the terminal behind the last '#', unless that is part of the file's name.
std::filesystem::path split_terminal(const std::filesystem::path& file, ReadOptions& options) {
  const std::string text = file.string();
  const auto at = text.rfind('#');
  if (at == std::string::npos || at == 0 || std::filesystem::exists(file)) return file;
  options.terminal = text.substr(at + 1);
  return text.substr(0, at);
}

}  // namespace

Record read_record(const std::filesystem::path& named, const RecordBase& base, const ReadOptions& given) {
  ReadOptions options = given;
  const std::filesystem::path file = split_terminal(named, options);
  Record record = parse_record(read_bytes(file), file.string(), base, options);
  record.name = file.filename().string();
  return record;
}

}  // namespace swingbank::validate
