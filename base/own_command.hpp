#pragma once
// Execution of this build's other commands as separate programs. Thus calibrate and add need not link the
// libraries of predict, train and generate.
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "base/child.hpp"
#include "base/own_executable.hpp"
#include "base/problem.hpp"

namespace swingbank::jobs {

/// Folder of the commands, set if the running executable is another program, such as Python. If empty, the
/// commands are in the executable's folder.
inline std::filesystem::path commands_folder;

/// Returns the folder of the commands of this build. Throws InputError if the executable's path is unknown.
inline std::filesystem::path own_folder() {
  if (!commands_folder.empty()) return commands_folder;
  std::error_code error;
  const auto program = own_executable(error);
  if (error)
    throw InputError({"cannot find the folder of Swingbank's commands", "/proc/self/exe", error.message(),
                      "mount /proc, or start swingbank by its path"});
  return program.parent_path();
}

/// Returns the path of `swingbank-<command>` in this program's folder. Throws InputError with `remedy` if it
/// is missing.
inline std::filesystem::path own_command(const std::string& command, const std::string& remedy) {
  const auto program = own_folder() / ("swingbank-" + command);
  if (::access(program.c_str(), X_OK) != 0)
    throw InputError(
        {"missing command swingbank " + command, program.string(), "this build does not have it", remedy});
  return program;
}

/// Runs a program to its end. Discards its standard output unless `shown`, and its standard error if
/// `silent`. Returns the exit code, or 128 + the signal's number if a signal ended it. Throws InputError if
/// it cannot be started.
inline int run_own(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                   bool shown = false, bool silent = false) {
  std::vector<std::string> words = {program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  using Output = ProgramRun::Output;
  return run_program(program, words, {shown ? Output::shown : Output::dropped, silent, 0.0}).code();
}

/// Replaces this process by a program with these arguments. Throws InputError if it cannot be started.
[[noreturn]] inline void replace_by(const std::filesystem::path& program,
                                    std::vector<std::string> arguments) {
  std::string name = program.string();
  std::vector<char*> words = {name.data()};
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  ::execv(name.c_str(), words.data());
  throw InputError({"cannot start the command", name, ::strerror(errno), "build or install it again"});
}

/// Temporary folder, removed with its content by the destructor.
class Scratch {
 public:
  Scratch() {
    std::string pattern = (std::filesystem::temp_directory_path() / "swingbank-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr)
      throw InputError({"cannot create a temporary folder", pattern, std::string(::strerror(errno)),
                        "set TMPDIR to a writable folder"});
    folder_ = pattern;
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  /// Returns the path of the folder.
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

}  // namespace swingbank::jobs
