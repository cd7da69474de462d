#include "base/input_file.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "base/durable.hpp"
#include "base/inputs_kept.hpp"
#include "base/own_executable.hpp"

namespace swingbank {

namespace fs = std::filesystem;

namespace {

/// Returns whether a path is a shell pattern; the shell passes it unexpanded if no file matches.
bool is_pattern(const fs::path& file) {
  return file.filename().string().find_first_of("*?[") != std::string::npos;
}

/// Returns the example with the relative path `file` ("configs/plants/x.toml" or "plants/x.toml"). For a
/// pattern, returns its folder. Empty if there is none.
fs::path example_of(const fs::path& file, const fs::path& examples) {
  if (examples.empty() || file.is_absolute()) return {};
  std::error_code ignored;
  for (const fs::path& root : {examples.parent_path(), examples}) {
    const fs::path candidate = root / file;
    if (!is_pattern(file) && fs::is_regular_file(candidate, ignored)) return candidate;
    if (is_pattern(file) && file.has_parent_path() && fs::is_directory(candidate.parent_path(), ignored))
      return candidate.parent_path();
  }
  return {};
}

std::string reason(const fs::path& file) {
  std::error_code error;
  if (fs::is_directory(file, error)) return "it is a folder";
  if (fs::exists(file, error) && !fs::is_regular_file(file, error))
    return "it is a pipe or a device, whose data may never end; save the data in a file";
  if (fs::exists(file, error)) {
    errno = 0;
    const bool opens = std::ifstream(file, std::ios::binary).is_open();
    if (!opens && errno != 0) return std::strerror(errno);
    return fs::is_empty(file, error) ? "it is empty" : "it cannot be read";
  }
  std::string why =
      is_pattern(file) ? "there is no such file, and no file matches this pattern" : "there is no such file";
  if (file.is_relative()) why += "; searched in " + fs::current_path(error).string();
  return why;
}

}  // namespace

fs::path example_configs() {
  std::error_code error;
  fs::path own = own_executable(error).parent_path();
  if (error) return {};
  if (own.filename().string().starts_with("x86-64-v")) own = own.parent_path();  // instruction-set folder
  // The first path is that of an installation, the second that of a build folder.
  for (const char* way : {SWINGBANK_CONFIGS_FROM_PROGRAMS, "../share/swingbank/configs"}) {
    const fs::path folder = fs::canonical(own / way, error);
    if (!error && fs::is_directory(folder, error)) return folder;
  }
  return {};
}

Problem unreadable(const fs::path& file, const std::string& what, const std::string& remedy,
                   const fs::path& examples) {
  std::error_code ignored;
  const fs::path example = fs::exists(file, ignored) ? fs::path() : example_of(file, examples);
  if (example.empty()) return {what, file.string(), reason(file), remedy};
  return {what, file.string(), reason(file),
          "Swingbank's example is " + example.string() + ": use that file, or run cp -r " +
              examples.string() + " . to copy all examples to the current folder"};
}

std::string read_input(const fs::path& file, const std::string& what, const std::string& remedy) {
  if (std::error_code error; fs::exists(file, error) && !fs::is_regular_file(file, error))
    throw InputError(unreadable(file, what, remedy));
  try {
    std::string text = read_text(file);
    note_input(file);
    if (!text.empty()) return text;
  } catch (const InputError& error) {
    if (std::error_code ignored; fs::is_regular_file(file, ignored))
      throw InputError({what, file.string(), error.problems().front().why, remedy});
  }
  throw InputError(unreadable(file, what, remedy));
}

}  // namespace swingbank
