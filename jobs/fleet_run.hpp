#pragma once
// Diagnosis of a fleet (swingbank diagnose --fleet): plants distributed over ranks, each diagnosed in a
// separate process, so that a crash or a lack of memory affects one plant only.
#include <string>
#include <vector>

#include "jobs/command_line.hpp"
#include "mpi/items/ranks.hpp"

namespace swingbank::jobs {

/// Options of a fleet's diagnosis.
struct FleetCommand {
  std::string fleet, out;
  /// Threads for one plant; 0: one per core; -1: one per core if a rank has the machine to itself, else 1.
  int threads = -1;
  bool json = false;
  double limit = 3600.0;  ///< time limit for one plant [s]; 0: none
};

/// Declares the options of `swingbank diagnose-fleet`, which runs a fleet under a launcher.
void declare_fleet(CommandLine& line, FleetCommand& command);
/// Returns the command as arguments of these options.
std::vector<std::string> fleet_words(const FleetCommand& command);

/// Diagnoses every plant on the ranks and prints the table. A plant's process is `swingbank-diagnose --plant`
/// in this program's folder; it prints {"was_there", "row"}. Returns the exit code, the same on all ranks: 0
/// all plants adequate, 3 some plant is not, 1 some plant failed or invalid input, 2 stopped by a signal.
int run_fleet(const FleetCommand& command, const mpi::items::Ranks& ranks);

}  // namespace swingbank::jobs
