// swingbank train: trains one network on a dataset split 60/20/20 by databank point (Table IV).
#include "jobs/commands.hpp"
#include "jobs/training_options.hpp"

int swingbank::jobs::train_command(CommandLine& line, int argc, char** argv) {
  using namespace swingbank;
  TrainingOptions options;
  const auto check = [&](const train::run::RunRequest& request) {
    if (request.experiment.leave_one_out)
      throw InputError({"this experiment leaves generators out", options.experiment, "see its split",
                        "use swingbank cross-validate"});
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
