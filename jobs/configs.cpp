// swingbank configs: prints the folder of the example configs.
#include <fmt/format.h>

#include "base/input_file.hpp"
#include "jobs/command_line.hpp"

namespace swingbank::jobs::configs_command {
int run(CommandLine& line, int argc, char** argv) {
  line.example("cp -r \"$(swingbank configs)\" .");
  line.footer("Paths inside a config refer to the folder of that config.");
  if (!line.parse(argc, argv)) return line.end();
  const auto folder = swingbank::example_configs();
  if (folder.empty()) {
    const swingbank::Problem problem{"no example configs", "share/swingbank/configs",
                                     "the folder that is installed with this program is not there",
                                     "install Swingbank again"};
    fmt::print(stderr, "{}\n", problem.sentence());
    return 1;
  }
  fmt::print("{}\n", folder.string());
  return 0;
}

}  // namespace swingbank::jobs::configs_command
