#pragma once
// What a shard's file is called: no folder of a dataset holds more than a thousand entries.
#include <cstdint>
#include <string>

namespace swingbank::mpi::store {

/// Below the dataset's folder: "shards/shard-000012.h5", of more than 1,000 shards
/// "shards/001/shard-001012.h5", of more than a million "shards/002/001/shard-2001012.h5".
std::string shard_file_name(std::uint64_t shard, std::uint64_t shards);

}  // namespace swingbank::mpi::store
