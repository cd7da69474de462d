#pragma once
// Diagnosis of a fleet (swingbank diagnose --fleet). The plants are distributed over ranks, and each is
// diagnosed in a separate process. A crash or a lack of memory thus affects only one plant.
#include <string>
#include <vector>

#include "jobs/command_line.hpp"
#include "mpi/items/ranks.hpp"

namespace swingbank::jobs {

/// Options of a fleet's diagnosis.
struct FleetCommand {
  std::string fleet, out;
  /// Threads for one plant; 0: one per core; -1: one per core if only one rank runs on the machine, else 1.
  int threads = -1;
  bool json = false;
  double limit = 3600.0;  ///< time limit for one plant [s]; 0: none
};

/// Declares the options of `swingbank diagnose-fleet`, which runs a fleet under a launcher.
void declare_fleet(CommandLine& line, FleetCommand& command);
/// Returns the arguments of `swingbank diagnose-fleet` that pass on these options.
std::vector<std::string> fleet_words(const FleetCommand& command);

/// Diagnoses every plant on the ranks and prints the table. Each plant is diagnosed by a process
/// `swingbank-diagnose --plant` of this program's folder, which prints {"was_there", "row"}. Returns the exit
/// code, the same on all ranks. 0: all plants are complete; 1: a plant failed or the input is invalid; 2:
/// stop signal; 3: some plant is not complete.
int run_fleet(const FleetCommand& command, const mpi::items::Ranks& ranks);

}  // namespace swingbank::jobs
