#pragma once
// Options and execution of `swingbank train`, in this process or on the ranks of a launcher.
#include <unistd.h>

#include <functional>
#include <optional>

#include "jobs/training_options.hpp"
#include "mpi/items/ranks.hpp"

namespace swingbank::jobs {

/// Declares the options, checks the request and calls `work` with options and request. Returns the exit code.
inline int train_main(CommandLine& line, int argc, char** argv,
                      const std::function<int(const TrainingOptions&, train::run::RunRequest&)>& work) {
  TrainingOptions options;
  line.add_flag("--watch", options.watch, "draw the learning curve on the terminal, after each epoch");
  const auto check = [&](const train::run::RunRequest& request) {
    if (request.experiment.split == train::loop::Split::leave_one_out)
      throw InputError({"this experiment has folds, one for each generator left out", options.experiment,
                        "its split is leave-one-generator-out", "use swingbank cross-validate"});
    if (options.watch && isatty(STDERR_FILENO) == 0)
      throw InputError({"no terminal to draw on", "--watch", "standard error is a file or a pipe",
                        "leave it out, and read the curve from curves/ in the folder of --out"});
  };
  return training_main(argc, argv, line, options, check,
                       [&](train::run::RunRequest request) { return work(options, request); });
}

/// Trains the network on the ranks together. Collective. Returns the exit code.
inline int train_on(const mpi::items::Ranks& ranks, const TrainingOptions& options,
                    train::run::RunRequest& request) {
  std::optional<train::data::ShardStream> stream;
  ranks.agree("the dataset", [&] {
    request.runtime = train::runtime::set_up_runtime(options.threads);
    stream.emplace(options.open(request));
  });
  request.ranks = &ranks;
  const train::run::RunOutcome outcome = train::run::run(*stream, request);
  if (outcome == train::run::RunOutcome::already_done && ranks.rank() == 0)
    fmt::print(stderr, "{}: done already\n", train::run::run_name(request));
  return exit_code(outcome);
}

}  // namespace swingbank::jobs
