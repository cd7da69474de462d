#pragma once
// Generation of a dataset on all ranks (`swingbank generate`).
#include <mpi.h>

#include "base/progress.hpp"
#include "mpi/draw/dataset_config.hpp"
#include "mpi/store/dataset.hpp"

namespace swingbank::mpi::ranks {

/// Options of `swingbank generate`.
struct GenerateOptions {
  std::filesystem::path folder;
  store::Part part;                ///< subset of the shards that this run generates
  std::filesystem::path databank;  ///< file of `swingbank databank`; empty: draw the databank
  int writer_ranks = 1;            ///< number of ranks that write a shard together
  double lease_timeout = 600.0;    ///< time limit of a lease [s]; 0: unlimited
  bool dedicated_master = false;   ///< rank 0 does not simulate
  bool repair = false;             ///< regenerate damaged shards
  std::string software = {};       ///< version and commit, for the card
  bool trust = false;  ///< check only the lengths of existing shards, or a complete dataset's manifest
  Progress::Mode progress = Progress::Mode::automatic;
};

/// Generates the missing shards of a dataset, or of one part of it. Collective over `world`. Returns the exit
/// code: 0, or 2 if shards are missing after a graceful stop. Throws the same InputError on all ranks.
int generate(const draw::DatasetConfig& config, const GenerateOptions& options, MPI_Comm world);

}  // namespace swingbank::mpi::ranks
