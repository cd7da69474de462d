#pragma once
// Verification of existing shards, distributed over all ranks because reading dominates its cost.
#include <mpi.h>

#include "mpi/store/dataset.hpp"

namespace swingbank::mpi::ranks {

/// Result of the verification.
struct ShardAudit {
  std::vector<store::BadShard> bad;  ///< damaged shards in order of number, on rank 0 only
  bool stopped = false;              ///< whether a stop signal ended it early; the same on all ranks
};

/// Checks the shards of `lines` with fault_of; each rank checks a part of them. `lines` is used on rank 0
/// only. Collective; throws the same InputError on all ranks.
ShardAudit audit_shards(MPI_Comm world, const std::filesystem::path& folder,
                        const store::DatasetHeader& header, const std::vector<store::JournalLine>& lines,
                        bool deep);

}  // namespace swingbank::mpi::ranks
