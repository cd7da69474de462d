#pragma once
// Diagnosis of a fleet (swingbank diagnose --fleet): plants distributed over ranks, each diagnosed in a
// separate process.
#include <string>

#include "validate/fleet/fleet.hpp"

namespace swingbank::jobs {

/// Options of a fleet's diagnosis.
struct FleetCommand {
  std::string fleet, out;
  /// Threads for one plant; 0: one per core; -1: one per core if a rank has the machine to itself, else 1.
  int threads = -1;
  bool json = false;
  double limit = 3600.0;  ///< time limit for one plant [s]; 0: none
};

/// Diagnoses every plant, on the ranks that mpirun or srun started or on this process alone, and prints the
/// table. Returns the exit code, the same on all ranks: 0 all plants adequate, 3 some plant is not, 1 some
/// plant failed or invalid input, 2 stopped by a signal.
int run_fleet(const FleetCommand& command, int* argc, char*** argv);

/// Diagnoses one plant of the fleet in this process and prints {"was_there", "row"} to standard output.
/// run_fleet starts it as a separate process, so that a crash or a lack of memory affects one plant only.
int run_fleet_plant(const FleetCommand& command, const std::string& plant);

}  // namespace swingbank::jobs
