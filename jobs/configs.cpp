// swingbank configs: where the example configs lie.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "base/input_file.hpp"

int main(int argc, char** argv) {
  CLI::App app{SWINGBANK_SUMMARY, "swingbank configs"};
  app.footer(
      "To have them here, and to change them:\n"
      "  cp -r \"$(swingbank configs)\" .\n"
      "Paths inside a config refer to the folder of that config.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 1;
  }
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
