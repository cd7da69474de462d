#pragma once
// Worker: a rank of a group that generates leased shards one after the other. Each rank simulates a part of a
// shard's draws (simulated events), and all ranks write the shard together through the MPI-IO driver.
#include <functional>

#include "mpi/draw/shard_maker.hpp"
#include "mpi/ranks/detail/message.hpp"

namespace swingbank::mpi::ranks {

/// Rank of a worker group.
struct Worker {
  const draw::Study& study;
  draw::ShardMaker& maker;
  store::ShardAttributes attributes;
  std::filesystem::path folder;
  MPI_Comm group;  ///< communicator of the group; its rank 0 is the leader
  /// Sends a report and returns the next lease; called by the leader only.
  std::function<Shards(const Report&)> exchange;
  /// Called repeatedly with the number of draws finished since the last call.
  std::function<void(std::uint64_t)> tick;

  /// Generates leased shards until an empty lease.
  void run();
  /// Generates the shards of a lease until all are done, one fails, or a stop signal arrives.
  Report work_off(const Shards& lease);
  /// Generates one shard. Collective over the group; throws the same InputError on all its ranks.
  store::JournalLine make(std::uint64_t shard);
  /// Returns the counts of a shard's operating points, for the journal. Collective over the group.
  [[nodiscard]] std::map<std::string, std::uint64_t> count_operating_points(
      const store::ShardData& part) const;
};

}  // namespace swingbank::mpi::ranks
