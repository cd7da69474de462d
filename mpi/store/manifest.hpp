#pragma once
// Manifest of a complete dataset (manifest.txt): the journals' entries in one file that is fast to read. With
// it, a dataset opens without access to each shard.
#include <filesystem>
#include <optional>
#include <vector>

#include "mpi/store/journal.hpp"

namespace swingbank::mpi::store {

constexpr const char* kManifestFile = "manifest.txt";  ///< file name in the dataset folder

/// Writes the manifest of `lines`, which must be all entries of the folder's journals.
void write_manifest(const std::filesystem::path& folder, const std::vector<JournalLine>& lines);
/// Returns the manifest's entries; nothing if there is no manifest, or if names or lengths of the journals
/// have changed since. Throws InputError if it is damaged.
std::optional<std::vector<JournalLine>> read_manifest(const std::filesystem::path& folder);

}  // namespace swingbank::mpi::store
