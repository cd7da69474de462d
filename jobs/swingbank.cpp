// swingbank <command> [arguments]: runs swingbank-<command> from this program's folder. That file is a
// symbolic link to the program that contains the command (run_command.cpp).
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "base/launcher.hpp"
#include "base/nearest_word.hpp"
#include "base/own_command.hpp"

namespace {

namespace fs = std::filesystem;

struct Command {
  std::string name;
  std::string summary;
  std::string group;      ///< heading in the help; empty: internal, not listed
  std::string component;  ///< component of an installation (cmake/install.cmake); empty: none
};

// Declared once, by swingbank_command() in jobs/CMakeLists.txt, in the order of the help.
const std::vector<Command> kDeclared = {
#include "commands.inc"
};

constexpr std::string_view kPrefix = "swingbank-";

/// Returns the available commands: declared ones first, then any other swingbank-* program in the folder.
std::vector<Command> found_commands(const fs::path& folder) {
  std::map<std::string, bool> present;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string file = entry.path().filename().string();
    if (file.starts_with(kPrefix) && access(entry.path().c_str(), X_OK) == 0) {
      present.emplace(file.substr(kPrefix.size()), true);
    }
  }
  std::vector<Command> commands;
  for (const auto& command : kDeclared) {
    if (present.erase(command.name) > 0) commands.push_back(command);
  }
  for (const auto& [name, unused] : present) commands.push_back({name, "", "Others", ""});
  return commands;
}

void print_help(const std::vector<Command>& commands) {
  fmt::print("swingbank {}: power-plant model validation at scale\n\n", SWINGBANK_VERSION);
  fmt::print("Usage: swingbank <command> [arguments]\n  or:  swingbank <command> --help\n");
  std::size_t width = 0;
  for (const auto& command : commands) width = std::max(width, command.name.size());
  std::string group;
  for (const auto& command : commands) {
    if (command.group.empty()) continue;
    if (command.group != group) fmt::print("\n{}:\n", command.group);
    group = command.group;
    fmt::print("  {:<{}}  {}\n", command.name, width, command.summary);
  }
}

int refuse(std::string_view wanted, const fs::path& folder, const std::vector<Command>& commands) {
  if (!swingbank::is_first_rank()) return 1;
  const auto declared = std::ranges::find(kDeclared, wanted, &Command::name);
  if (declared != kDeclared.end()) {
    fmt::print(stderr, "command '{}' is not installed at {} (no {}{} there): {}\n", wanted, folder.string(),
               kPrefix, wanted,
               declared->component.empty() ? "run it in a build folder"
                                           : "install " + std::string(kPrefix) + declared->component);
    return 1;
  }
  std::vector<std::string> names;
  for (const auto& command : commands)
    if (!command.group.empty()) names.push_back(command.name);
  const std::string guess = swingbank::nearest_word(wanted, names);
  const std::string remedy =
      guess.empty() ? "run swingbank --help for the list" : fmt::format("did you mean '{}'?", guess);
  fmt::print(stderr, "unknown command '{}' at {} (no {}{} there): {}\n", wanted, folder.string(), kPrefix,
             wanted, remedy);
  return 1;
}

/// Instruction-set level (x86-64 psABI) for which a build may contain programs, in addition to the common
/// programs for every x86-64 processor.
struct Level {
  std::string_view name;
  bool supported;
};
std::vector<Level> levels() {
  const bool v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                  __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
  const bool v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                  __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
                  __builtin_cpu_supports("avx512vl");
  return {{"x86-64-v4", v4}, {"x86-64-v3", v3}};
}

/// Returns the program for the highest level that this processor supports and this build contains, else the
/// common program. The environment variable SWINGBANK_LEVEL selects a level instead: a name of levels(), or
/// "common". Returns an empty path if processor or build do not support the selected level.
fs::path program_for_this_processor(const fs::path& folder, const std::string& name) {
  const fs::path file = std::string(kPrefix) + name;
  const char* asked = std::getenv("SWINGBANK_LEVEL");
  if (asked != nullptr && std::string_view(asked) == "common") return folder / file;
  for (const Level& level : levels()) {
    if (!level.supported || (asked != nullptr && asked != level.name)) continue;
    fs::path program = folder / level.name / file;
    if (access(program.c_str(), X_OK) == 0) return program;
  }
  return asked == nullptr ? folder / file : fs::path();
}

int run(const fs::path& folder, const std::string& name, char** arguments) {
  std::string program = program_for_this_processor(folder, name).string();
  if (program.empty()) {
    if (swingbank::is_first_rank())
      fmt::print(
          stderr,
          "instruction set {} at SWINGBANK_LEVEL (this processor or this build does not have it): take "
          "x86-64-v4, x86-64-v3 or common, or unset it\n",
          std::getenv("SWINGBANK_LEVEL"));
    return 1;
  }
  std::vector<char*> argv{program.data()};
  for (; *arguments != nullptr; ++arguments) argv.push_back(*arguments);
  argv.push_back(nullptr);
  execv(program.c_str(), argv.data());
  fmt::print(stderr, "command cannot be started at {} ({}): build it again\n", program, std::strerror(errno));
  return 1;
}

int dispatch(int argc, char** argv) {
  const fs::path folder = swingbank::jobs::own_folder();
  const auto commands = found_commands(folder);
  const std::string first = argc > 1 ? argv[1] : "";
  if (first.empty()) {
    if (swingbank::is_first_rank()) print_help(commands);
    return 1;
  }
  if (first == "--version") {
    if (swingbank::is_first_rank()) fmt::print("swingbank {}\n", SWINGBANK_VERSION);
    return 0;
  }
  if (first == "--help" || first == "-h" || (first == "help" && argc == 2)) {
    if (swingbank::is_first_rank()) print_help(commands);
    return 0;
  }
  const bool help_on = first == "help";
  const std::string name = help_on ? argv[2] : first;
  const bool known =
      std::any_of(commands.begin(), commands.end(), [&](const auto& c) { return c.name == name; });
  if (!known) return refuse(name, folder, commands);
  std::string help = "--help";
  char* ask[] = {help.data(), nullptr};
  return run(folder, name, help_on ? ask : argv + 2);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return dispatch(argc, argv);
  } catch (const swingbank::InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
