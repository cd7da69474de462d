// swingbank train: trains one network on a dataset split 60/20/20 by databank point (Table IV). The ranks of
// mpirun or srun train it together.
#include <unistd.h>

#include "jobs/training_options.hpp"
#include "mpi/items/one_process.hpp"
#include "mpi/ranks/item_ranks.hpp"
#include "mpi/ranks/session.hpp"

namespace swingbank::jobs::train_command {
namespace {

/// Trains the network on the ranks together. Returns the exit code.
int train_on(const mpi::items::Ranks& ranks, const TrainingOptions& options,
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

}  // namespace

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
    if (train::runtime::launcher_place().size == 1)
      return train_on(mpi::items::OneProcess(), options, request);
    const mpi::ranks::MpiSession session(&argc, &argv);
    return mpi::ranks::run_on_all_ranks(
        session, [&] { return train_on(mpi::ranks::ItemRanks(MPI_COMM_WORLD), options, request); });
  });
}

}  // namespace swingbank::jobs::train_command
