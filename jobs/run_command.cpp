// Main function of the programs that contain several commands. The name by which such a program is started
// selects the command: swingbank-<command> is a symbolic link to the program. Exceptions of a command are
// printed here.
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

#include "jobs/command_line.hpp"
#include "jobs/guarded.hpp"

// swingbank_program() in cmake/targets.cmake generates these files; the second is the table of commands.
#include "declarations.inc"

namespace {

using namespace swingbank::jobs;

struct Command {
  std::string_view name;
  std::string_view summary;
  CommandFunction* run;
};

constexpr Command kCommands[] = {
#include "commands_of_program.inc"
};

}  // namespace

int main(int argc, char** argv) {
  const std::string program = argc > 0 ? std::filesystem::path(argv[0]).filename().string() : "";
  for (const Command& command : kCommands)
    if (program == "swingbank-" + std::string(command.name)) {
      const std::string name(command.name);
      CommandLine line(std::string(command.summary), "swingbank " + name);
      return guarded(name, [&] { return command.run(line, argc, argv); });
    }
  std::fprintf(
      stderr,
      "'%s' is not a Swingbank command; start the program through a link swingbank-<command>, or run swingbank --help\n",
      program.c_str());
  return 1;
}
