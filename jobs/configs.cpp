// swingbank configs: prints the path of the example configs.
#include <fmt/format.h>

#include "base/input_file.hpp"
#include "jobs/command_line.hpp"

namespace swingbank::jobs::configs_command {
int run(CommandLine& line, int argc, char** argv) {
  line.example("cp -r \"$(swingbank configs)\" .");
  line.footer("Relative paths in a config file are resolved against the folder of that file.");
  if (!line.parse(argc, argv)) return line.end();
  const auto folder = swingbank::example_configs();
  if (folder.empty()) {
    const swingbank::Problem problem{"no example configs", "share/swingbank/configs",
                                     "the installed folder of example configs does not exist",
                                     "install Swingbank again"};
    fmt::print(stderr, "{}\n", problem.sentence());
    return 1;
  }
  fmt::print("{}\n", folder.string());
  return 0;
}

}  // namespace swingbank::jobs::configs_command
