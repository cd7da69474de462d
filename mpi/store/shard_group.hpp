#pragma once
// Writing one shard by a group of ranks through HDF5's MPI-IO driver.
#include <mpi.h>

#include <functional>

#include "mpi/store/shard.hpp"

namespace swingbank {

struct ShardReceipt {
  std::uint64_t rows = 0, draws = 0, bytes = 0, hash = 0;
};

/// Runs `work` on every rank of the group, then all agree: if it threw on any, all throw the problems of the
/// first such rank. `where` stands for the place in messages of exceptions that are no InputError.
void agree(MPI_Comm group, const std::string& where, const std::function<void()>& work);

/// Collective over `group`: each rank brings consecutive rows and draws, in order of rank; attributes and
/// shapes are the same on all. Temporary name, close, fsync, rename, fsync of the folder, all before it
/// returns. On failure every rank throws InputError with the reason of the rank that failed, and the
/// temporary file is gone.
ShardReceipt write_shard(const std::filesystem::path& file, const ShardData& part, MPI_Comm group);

}  // namespace swingbank
