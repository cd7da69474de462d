#pragma once
// dataset.h5: an HDF5 virtual dataset over all shards of a finished dataset, for whoever reads it with h5py.
#include <filesystem>

#include "mpi/store/dataset.hpp"

namespace swingbank::mpi::store {

constexpr const char* kVirtualFile = "dataset.h5";
/// Beyond so many shards it would take a minute to describe them all (docs/performance.md), and none is made.
constexpr std::uint64_t kMostVirtual = 100000;

/// Writes it: the arrays of the shards one after the other, in order of shard number, by names below the
/// folder, so that it moves with it. False where the dataset has no rows or more shards than kMostVirtual.
bool write_virtual_dataset(const Dataset& dataset);

}  // namespace swingbank::mpi::store
