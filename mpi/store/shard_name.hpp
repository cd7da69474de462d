#pragma once
// File names of shards, in subfolders of at most a thousand entries.
#include <cstdint>
#include <string>

namespace swingbank::mpi::store {

/// Returns the file name of a shard relative to the dataset's folder: "shards/shard-000012.h5"; with more
/// than 1,000 shards "shards/001/shard-001012.h5"; with more than a million
/// "shards/002/001/shard-2001012.h5".
std::string shard_file_name(std::uint64_t shard, std::uint64_t shards);

}  // namespace swingbank::mpi::store
