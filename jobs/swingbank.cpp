// swingbank <command> [arguments]: runs swingbank-<command> from this program's own folder, so that each
// command links only the libraries it uses.
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

namespace {

namespace fs = std::filesystem;

struct Command {
  std::string name;
  std::string summary;
};

// Declared once, as SUMMARY of swingbank_command() in jobs/CMakeLists.txt, in the order data meets the
// commands.
const std::vector<Command> kDeclared = {
#include "commands.inc"
};

constexpr std::string_view kPrefix = "swingbank-";

fs::path own_folder() { return fs::read_symlink("/proc/self/exe").parent_path(); }

/// Commands that can be run: declared and present first, then any further swingbank-* program in the folder.
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
  for (const auto& [name, unused] : present) commands.push_back({name, ""});
  return commands;
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replace});
    }
  }
  return row.back();
}

std::string nearest(std::string_view wanted, const std::vector<Command>& commands) {
  std::string best;
  std::size_t fewest = std::max<std::size_t>(2, wanted.size() / 2);  // farther than this is no likely slip
  for (const auto& command : commands) {
    const bool begins = wanted.size() >= 3 && command.name.starts_with(wanted);
    const std::size_t distance = begins ? 0 : edit_distance(wanted, command.name);
    if (distance <= fewest && (best.empty() || distance < fewest)) {
      best = command.name;
      fewest = distance;
    }
  }
  return best;
}

void print_help(const std::vector<Command>& commands) {
  fmt::print("swingbank {}: power-plant model validation at scale\n\n", SWINGBANK_VERSION);
  fmt::print("Usage: swingbank <command> [arguments]\n  or:  swingbank <command> --help\n\nCommands:\n");
  std::size_t width = 0;
  for (const auto& command : commands) width = std::max(width, command.name.size());
  for (const auto& command : commands) fmt::print("  {:<{}}  {}\n", command.name, width, command.summary);
}

/// Under mpirun or srun every rank runs this program; only the first one speaks.
bool speaks() {
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"}) {
    if (const char* rank = std::getenv(name)) return std::strcmp(rank, "0") == 0;
  }
  return true;
}

int refuse(std::string_view wanted, const fs::path& folder, const std::vector<Command>& commands) {
  if (!speaks()) return 1;
  const std::string guess = nearest(wanted, commands);
  const std::string remedy =
      guess.empty() ? "run swingbank --help for the list" : fmt::format("did you mean '{}'?", guess);
  fmt::print(stderr, "unknown command at '{}' (no {}{} in {}): {}\n", wanted, kPrefix, wanted,
             folder.string(), remedy);
  return 1;
}

/// Levels of instruction sets that a build may bring beside the common one, widest first.
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

/// The program in the folder of the widest level that this processor has, else the common one.
/// SWINGBANK_LEVEL asks for another: a name of levels(), or "common". Empty if it asks for what this
/// processor or build has not.
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
    if (speaks())
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

}  // namespace

int main(int argc, char** argv) {
  const fs::path folder = own_folder();
  const auto commands = found_commands(folder);
  const std::string first = argc > 1 ? argv[1] : "";
  if (first.empty()) {
    if (speaks()) print_help(commands);
    return 1;
  }
  if (first == "--version") {
    if (speaks()) fmt::print("swingbank {}\n", SWINGBANK_VERSION);
    return 0;
  }
  if (first == "--help" || first == "-h" || (first == "help" && argc == 2)) {
    if (speaks()) print_help(commands);
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
