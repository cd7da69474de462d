#pragma once
// Detection of a launcher of several ranks (mpirun, srun) from environment variables, without calls of MPI.
#include <cstdlib>
#include <cstring>

namespace swingbank {

/// Returns whether mpirun, srun or another launcher started this process.
inline bool launched() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "SLURM_STEP_ID"})
    if (std::getenv(name) != nullptr) return true;
  return false;
}

/// Returns whether this process prints: rank 0, or a process without a launcher.
inline bool is_first_rank() {
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"})
    if (const char* rank = std::getenv(name)) return std::strcmp(rank, "0") == 0;
  return true;
}

}  // namespace swingbank
