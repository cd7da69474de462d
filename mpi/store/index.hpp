#pragma once
// Index files of a complete dataset: the manifest for Swingbank's readers, and dataset.h5 for other programs.
#include <filesystem>

namespace swingbank::mpi::store {

/// Writes the missing index files of a complete dataset; does nothing if shards are missing. The caller must
/// hold a lock on the folder.
void index_dataset(const std::filesystem::path& folder);

}  // namespace swingbank::mpi::store
