#pragma once
// Layout of a shard file, common to the serial and the MPI-IO writer.
#include "mpi/store/hdf5_file.hpp"
#include "mpi/store/shard.hpp"

namespace swingbank::mpi::store {

constexpr const char* kShardFormat = "swingbank-shard-1";  ///< records as float32
constexpr const char* kInt16Format = "swingbank-shard-2";  ///< records as 16-bit integers

/// Numbers of rows and draws (simulated events) in the whole file, summed over all writers.
struct ShardSize {
  std::uint64_t rows, draws;  ///< numbers of rows and draws
};

/// Labels of the axes of a dataset's arrays.
struct ShardAxes {
  const std::vector<std::string>&channel_names, &parameter_names;  ///< of /records and /parameters
  std::uint64_t samples;                                           ///< samples per channel and row
  double rate;                                                     ///< sampling rate [1/s]
};
/// Creates the dimension scales, writes units and descriptions of the file's arrays, and attaches the scales
/// to the arrays. Collective if the file was opened collectively.
void lay_out_axes(h5::File& file, const ShardAxes& axes);
/// Writes the values of the dimension scales. Not collective.
void fill_axes(h5::File& file, const ShardAxes& axes);

/// Creates arrays and attributes; `data` gives the shape of a row and the attributes. Collective if the file
/// was opened collectively.
void lay_out_shard(h5::File& file, const ShardData& data, ShardSize size);
/// Writes the rows and draws of `data` from the given positions on. Not collective.
void fill_shard(h5::File& file, const ShardData& data, std::uint64_t first_row, std::uint64_t first_draw);

}  // namespace swingbank::mpi::store
