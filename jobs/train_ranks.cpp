// swingbank train-ranks: implementation of `swingbank train` under mpirun or srun. `train` starts it as a
// separate program, so that only trainings on several ranks load MPI and parallel HDF5.
#include "jobs/train_on.hpp"
#include "mpi/ranks/item_ranks.hpp"
#include "mpi/ranks/session.hpp"

namespace swingbank::jobs::train_ranks_command {

int run(CommandLine& line, int argc, char** argv) {
  return train_main(line, argc, argv, [&](const TrainingOptions& options, train::run::RunRequest& request) {
    const mpi::ranks::MpiSession session(&argc, &argv);
    return mpi::ranks::run_on_all_ranks(
        session, [&] { return train_on(mpi::ranks::ItemRanks(MPI_COMM_WORLD), options, request); });
  });
}

}  // namespace swingbank::jobs::train_ranks_command
