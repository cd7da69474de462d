// swingbank train: trains one network on a dataset split 60/20/20 by databank sample (the thesis's Table IV),
// or with a split across datasets. Under mpirun or srun, the program with MPI replaces this process, and the
// ranks train the network together.
#include "base/own_command.hpp"
#include "jobs/train_on.hpp"
#include "mpi/items/one_process.hpp"

namespace swingbank::jobs::train_command {

int run(CommandLine& line, int argc, char** argv) {
  return train_main(line, argc, argv, [&](const TrainingOptions& options, train::run::RunRequest& request) {
    if (train::runtime::launcher_place().size == 1)
      return train_on(mpi::items::OneProcess(), options, request);
    replace_by(own_command("train-ranks", "install swingbank-train whole"), {argv + 1, argv + argc});
  });
}

}  // namespace swingbank::jobs::train_command
