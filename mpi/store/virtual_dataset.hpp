#pragma once
// Virtual dataset (dataset.h5): all shards of a complete dataset as one HDF5 file, for h5py and other
// readers.
#include <filesystem>

#include "mpi/store/dataset.hpp"

namespace swingbank::mpi::store {

constexpr const char* kVirtualFile = "dataset.h5";  ///< file name in the dataset folder
/// Largest number of shards for which the file is written; for more it would take over a minute
/// (docs/reference/performance.md).
constexpr std::uint64_t kMostVirtual = 100000;

/// Writes the file: the arrays of all shards, concatenated in order of shard number, with relative paths, so
/// that the folder can be moved. Returns false if the dataset has no rows or more shards than kMostVirtual.
bool write_virtual_dataset(const Dataset& dataset);

}  // namespace swingbank::mpi::store
