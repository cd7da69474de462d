// swingbank schema-experiment: internal command that prints the JSON Schema of experiments for `swingbank
// schema`.
#include <fmt/format.h>

#include "jobs/command_line.hpp"
#include "train/loop/experiment.hpp"

namespace swingbank::jobs::schema_experiment_command {
int run(CommandLine& line, int argc, char** argv) {
  if (!line.parse(argc, argv)) return line.end();
  fmt::print("{}", train::loop::experiment_schema());
  return 0;
}

}  // namespace swingbank::jobs::schema_experiment_command
