#pragma once
// swingbank diagnose --fleet: plants spread over ranks, each diagnosed by a process of its own.
#include <string>

#include "validate/fleet/fleet.hpp"

namespace swingbank::jobs {

struct FleetCommand {
  std::string fleet, out;
  int threads = -1;  ///< of one plant's diagnosis; 0: one per core; -1: that where a rank has the machine to
                     ///< itself, else 1
  bool json = false;
  double limit = 3600.0;  ///< of one plant's diagnosis [s]; 0: none
};

/// Every plant on the ranks that mpirun or srun started, or on this process alone; then the table. Returns
/// the exit code, the same on all ranks: 0 all adequate, 3 some plant is not, 1 some plant failed or bad
/// input, 2 stopped by a signal.
int run_fleet(const FleetCommand& command, int* argc, char*** argv);

/// One plant of the fleet, in this process; prints {"was_there", "row"} on stdout. What run_fleet starts, so
/// that a crash, or a plant that runs out of memory, costs one plant.
int run_fleet_plant(const FleetCommand& command, const std::string& plant);

}  // namespace swingbank::jobs
