#pragma once
// Reading of shards with unverified checksums in a separate process, because HDF5 1.10 may crash on a damaged
// file.
#include "mpi/store/dataset.hpp"
#include "mpi/store/shard.hpp"

namespace swingbank::mpi::store {

/// Reads a shard as read_shard does; a crash of the reader is reported as a damaged file.
ShardData read_shard_apart(const std::filesystem::path& file, const ShardFields& fields = {},
                           const ShardShape* shape = nullptr);

/// Reads a shard of a dataset. Throws InputError if length, shapes or config hash differ from the dataset's.
ShardData read_shard_apart(const ShardInfo& shard, const ShardFields& fields);

}  // namespace swingbank::mpi::store
