#pragma once
// Parallel writing of a shard by a group of ranks through HDF5's MPI-IO driver.
#include <mpi.h>

#include <functional>

#include "base/problem.hpp"
#include "mpi/store/shard.hpp"

namespace swingbank::mpi::ranks {

/// Counts and hashes of a written shard.
struct ShardReceipt {
  std::uint64_t rows = 0, draws = 0, bytes = 0, hash = 0;
  std::string file_hash;  ///< hash of the file's bytes, on rank 0 of the group only
};

/// Error that every rank of a group throws. Any other exception concerns one rank only, and the other ranks
/// would wait for it forever; see end_all_ranks.
class AgreedError : public InputError {
 public:
  using InputError::InputError;
};

/// Prints "failure at rank 1 of 3 (<why>): ..." and ends all ranks. For exceptions other than AgreedError.
[[noreturn]] void end_all_ranks(const char* why);

/// Runs `work` on every rank of the group. If it throws on any rank, all ranks throw the problems of the
/// first such rank as an AgreedError. `where`: the place named in the message if the exception is not an
/// InputError. Collective.
void agree(MPI_Comm group, const std::string& where, const std::function<void()>& work);

/// Writes a shard atomically. Collective over `group`. Each rank provides its consecutive rows and draws, in
/// order of rank; attributes and shapes are the same on all ranks. On failure, removes the temporary file,
/// and every rank throws an AgreedError with the problems of the failed rank.
ShardReceipt write_shard(const std::filesystem::path& file, const store::ShardData& part, MPI_Comm group);

}  // namespace swingbank::mpi::ranks
