#pragma once
// Launchers of several ranks (mpirun, srun), as far as this process's environment shows them, without MPI.
#include <cstdlib>
#include <cstring>

namespace swingbank {

/// Returns whether mpirun, srun or another launcher started this process.
inline bool launched() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "SLURM_STEP_ID"})
    if (std::getenv(name) != nullptr) return true;
  return false;
}

/// Returns true for rank 0 of a launcher and for a process without one: the process that prints.
inline bool is_first_rank() {
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"})
    if (const char* rank = std::getenv(name)) return std::strcmp(rank, "0") == 0;
  return true;
}

}  // namespace swingbank
