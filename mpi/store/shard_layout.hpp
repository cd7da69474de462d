#pragma once
// What a shard file contains, in one place for the serial and the MPI-IO writer.
#include "mpi/store/hdf5_file.hpp"
#include "mpi/store/shard.hpp"

namespace swingbank::mpi::store {

constexpr const char* kShardFormat = "swingbank-shard-1";
constexpr const char* kInt16Format = "swingbank-shard-2";  ///< the same with records as int16

struct ShardSize {
  std::uint64_t rows, draws;  ///< of the whole file, over all writers
};

/// Creates arrays and attributes; `data` gives shapes per row and the attributes. Collective if the file is.
void lay_out_shard(h5::File& file, const ShardData& data, ShardSize size);
/// Writes the rows and draws of `data` at the given places. Independent.
void fill_shard(h5::File& file, const ShardData& data, std::uint64_t first_row, std::uint64_t first_draw);

}  // namespace swingbank::mpi::store
