#pragma once
// Whether the shards of a journal can be trusted, asked by all ranks together: reading them is what costs.
#include <mpi.h>

#include "mpi/store/dataset.hpp"

namespace swingbank::mpi::ranks {

struct ShardAudit {
  std::vector<store::BadShard> bad;  ///< on rank 0, in order of shard number
  bool stopped = false;              ///< a signal ended it early; the same on all ranks
};

/// Collective. Rank 0 gives each rank its part of `lines`, which counts there only; each looks at its shards
/// with fault_of. Throws InputError on all ranks alike.
ShardAudit audit_shards(MPI_Comm world, const std::filesystem::path& folder,
                        const store::DatasetHeader& header, const std::vector<store::JournalLine>& lines,
                        bool deep);

}  // namespace swingbank::mpi::ranks
