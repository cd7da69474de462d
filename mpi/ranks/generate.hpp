#pragma once
// `swingbank generate`: databank, master, workers, dataset folder.
#include <mpi.h>

#include "base/progress.hpp"
#include "mpi/draw/dataset_config.hpp"
#include "mpi/store/dataset.hpp"

namespace swingbank::mpi::ranks {

struct GenerateOptions {
  std::filesystem::path folder;
  store::Part part;                ///< of the shards, made beside runs that make the others
  std::filesystem::path databank;  ///< what `swingbank databank` wrote; empty: drawn
  int writer_ranks = 1;            ///< ranks that share a shard
  double lease_timeout = 600.0;    ///< a shard may take that long [s]; 0: for ever
  bool dedicated_master = false;   ///< rank 0 only leads
  bool repair = false;             ///< make shards anew that are journalled and bad
  std::string software = {};       ///< of the card: version and commit
  bool trust = false;              ///< of journalled shards, look at the length only
  Progress::Mode progress = Progress::Mode::automatic;
};

/// Collective over `world`. Makes the dataset, or what is missing of it or of a part. Returns 0, or 2 after a
/// soft exit with shards still to make. Throws InputError on all ranks alike.
int generate(const draw::DatasetConfig& config, const GenerateOptions& options, MPI_Comm world);

}  // namespace swingbank::mpi::ranks
