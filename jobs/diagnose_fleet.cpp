// swingbank diagnose-fleet: implementation of `swingbank diagnose --fleet` under mpirun or srun. `diagnose`
// starts it as a separate program, so that only fleets on several ranks load MPI.
#include "jobs/command_line.hpp"
#include "jobs/fleet_run.hpp"
#include "mpi/ranks/item_ranks.hpp"
#include "mpi/ranks/session.hpp"

namespace swingbank::jobs::diagnose_fleet_command {
int run(CommandLine& line, int argc, char** argv) {
  FleetCommand c;
  declare_fleet(line, c);
  if (!line.parse(argc, argv)) return line.end();
  const mpi::ranks::MpiSession session(&argc, &argv);
  return mpi::ranks::run_on_all_ranks(session,
                                      [&] { return run_fleet(c, mpi::ranks::ItemRanks(MPI_COMM_WORLD)); });
}

}  // namespace swingbank::jobs::diagnose_fleet_command
