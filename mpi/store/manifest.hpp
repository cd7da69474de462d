#pragma once
// manifest.txt: what the journals of a finished dataset say, in one file that is read fast. Where it stands,
// a dataset is opened without a look at each of its files.
#include <filesystem>
#include <optional>
#include <vector>

#include "mpi/store/journal.hpp"

namespace swingbank::mpi::store {

constexpr const char* kManifestFile = "manifest.txt";

/// Writes the manifest of the lines, which are all that the journals of `folder` hold.
void write_manifest(const std::filesystem::path& folder, const std::vector<JournalLine>& lines);
/// Nothing where there is none, or where the journals are no longer those that it was made of (their names
/// and lengths). Throws InputError if it is damaged.
std::optional<std::vector<JournalLine>> read_manifest(const std::filesystem::path& folder);

}  // namespace swingbank::mpi::store
