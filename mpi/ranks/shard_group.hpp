#pragma once
// Writing one shard by a group of ranks through HDF5's MPI-IO driver.
#include <mpi.h>

#include <functional>

#include "base/problem.hpp"
#include "mpi/store/shard.hpp"

namespace swingbank::mpi::ranks {

struct ShardReceipt {
  std::uint64_t rows = 0, draws = 0, bytes = 0, hash = 0;
  std::string file_hash;  ///< of the file's bytes, on rank 0 of the group only
};

/// An error that every rank of a group throws alike. Any other exception is one rank's own, and the others do
/// not know of it: they would wait for that rank for ever (end_all_ranks).
class AgreedError : public InputError {
 public:
  using InputError::InputError;
};

/// Prints "failure at rank 1 of 3 (<why>): ..." and ends all ranks. For an exception that was not agreed
/// upon.
[[noreturn]] void end_all_ranks(const char* why);

/// Runs `work` on every rank of the group, then all agree: if it threw on any, all throw the problems of the
/// first such rank as an AgreedError. `where` stands for the place in messages of exceptions that are no
/// InputError.
void agree(MPI_Comm group, const std::string& where, const std::function<void()>& work);

/// Collective over `group`: each rank brings consecutive rows and draws, in order of rank; attributes and
/// shapes are the same on all. Temporary name, close, fsync, rename, fsync of the folder, all before it
/// returns. On failure every rank throws AgreedError with the reason of the rank that failed, and the
/// temporary file is gone.
ShardReceipt write_shard(const std::filesystem::path& file, const store::ShardData& part, MPI_Comm group);

}  // namespace swingbank::mpi::ranks
