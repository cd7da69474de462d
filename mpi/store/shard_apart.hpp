#pragma once
// Shards that nobody has compared with a sum, read by a process of its own: HDF5 1.10 may crash on a damaged
// file.
#include "mpi/store/dataset.hpp"
#include "mpi/store/shard.hpp"

namespace swingbank::mpi::store {

/// As read_shard; a crash is a problem of the file too.
ShardData read_shard_apart(const std::filesystem::path& file, const ShardFields& fields = {},
                           const ShardShape* shape = nullptr);

/// A dataset's shard: length, shapes and config hash must be what the dataset says. Throws InputError.
ShardData read_shard_apart(const ShardInfo& shard, const ShardFields& fields);

}  // namespace swingbank::mpi::store
