#pragma once
// What is made of a dataset once it is whole: the manifest for our readers, dataset.h5 for everybody's.
#include <filesystem>

namespace swingbank::mpi::store {

/// Writes what is not there yet; nothing where shards are still to be made. Whoever calls it holds a lock on
/// the folder.
void index_dataset(const std::filesystem::path& folder);

}  // namespace swingbank::mpi::store
