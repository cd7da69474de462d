#pragma once
// Verification of a dataset's shards on several cores, without MPI. HDF5 allows one thread at a time, so
// child processes read the shards.
#include <functional>
#include <string>

#include "mpi/store/dataset.hpp"

namespace swingbank::mpi::store {

/// Returns a damaged shard as a line of text, to be sent to another process.
std::string bad_shard_text(const BadShard& bad);
/// Parses a line of bad_shard_text().
BadShard parse_bad_shard(const std::string& text);

/// Checks the shards of `lines` with fault_of in `processes` child processes; 1: in this process. Calls
/// `done` after each shard. Returns the damaged shards in order of number. No thread may have been started
/// before, because the child processes are forked.
std::vector<BadShard> bad_shards(
    const std::filesystem::path& folder, const DatasetHeader& header, const std::vector<JournalLine>& lines,
    int processes, const std::function<void()>& done = [] {});

/// Checks all shards in this process. Throws InputError with every damaged shard.
void verify_dataset(const Dataset& dataset);

}  // namespace swingbank::mpi::store
