#pragma once
// A worker: a group of ranks that makes one leased shard after the other. Each rank simulates a part of the
// shard's draws; all write it together through the MPI-IO driver.
#include <functional>

#include "mpi/draw/shard_maker.hpp"
#include "mpi/ranks/detail/message.hpp"

namespace swingbank::mpi::ranks {

struct Worker {
  const draw::Study& study;
  draw::ShardMaker& maker;
  store::ShardAttributes attributes;
  std::filesystem::path folder;
  MPI_Comm group;  ///< rank 0 of it is the leader
  /// Leader only: hands in a report, returns the next lease.
  std::function<Shards(const Report&)> exchange;
  /// Called now and then with the number of draws finished since.
  std::function<void(std::uint64_t)> tick;

  /// Works until there is no more.
  void run();
  /// Makes the shards of a lease until all are made, one cannot be made, or a signal asks for an end.
  Report work_off(const Shards& lease);
  /// Makes one shard. Collective over the group; throws InputError on all its ranks alike.
  store::JournalLine make(std::uint64_t shard);
  /// Of one shard, for the journal. Collective over the group.
  [[nodiscard]] std::map<std::string, std::uint64_t> count_operating_points(
      const store::ShardData& part) const;
};

}  // namespace swingbank::mpi::ranks
