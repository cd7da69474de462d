// swingbank train: trains one network on a dataset split 60/20/20 by databank point (Table IV).
#include <unistd.h>

#include "jobs/training_options.hpp"

namespace swingbank::jobs::train_command {
int run(CommandLine& line, int argc, char** argv) {
  using namespace swingbank;
  TrainingOptions options;
  line.add_flag("--watch", options.watch, "draw the learning curve on the terminal, after each epoch");
  const auto check = [&](const train::run::RunRequest& request) {
    if (request.experiment.leave_one_out)
      throw InputError({"this experiment leaves generators out", options.experiment, "see its split",
                        "use swingbank cross-validate"});
    if (options.watch && isatty(STDERR_FILENO) == 0)
      throw InputError({"no terminal to draw on", "--watch", "standard error is a file or a pipe",
                        "leave it out, and read the curve from curves/ in the folder of --out"});
  };
  return training_main(argc, argv, line, options, check, [&](train::run::RunRequest request) {
    request.runtime = train::runtime::set_up_runtime(options.threads);
    const train::data::ShardStream stream = options.open(request);
    const train::run::RunOutcome outcome = train::run::run(stream, request);
    if (outcome == train::run::RunOutcome::already_done)
      fmt::print(stderr, "{}: done already\n", train::run::run_name(request));
    return exit_code(outcome);
  });
}

}  // namespace swingbank::jobs::train_command
