#pragma once
// Preparation of a dataset folder: locks, header, removal of leftovers of earlier runs, and list of missing
// shards.
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "base/run_lock.hpp"
#include "mpi/ranks/generate.hpp"

namespace swingbank::mpi::ranks {

/// Locks that a run holds until it ends: one on the folder, exclusive or shared with the runs of other parts
/// (`--part`), and one on its part.
struct FolderLocks {
  std::unique_ptr<RunLock> folder, part;
  /// Removes the lock files from a folder that the run rejects.
  void withdraw() {
    folder->withdraw();
    if (part) part->withdraw();
  }
};

/// Locks the folder, writes its header if it is new, calls `furnish`, which may add files, and removes
/// temporary files of killed runs. Runs of other parts wait meanwhile. Throws InputError if the folder is in
/// use, contains a dataset of another config, or contains files but no dataset.
FolderLocks enter(const GenerateOptions& options, const store::DatasetHeader& header,
                  const std::function<void()>& furnish);

/// Returns whether the folder contains a dataset and is read-only.
bool is_archive(const std::filesystem::path& folder);
/// Throws InputError if the folder's dataset has another config hash.
void require_same_config(const std::filesystem::path& folder, const store::DatasetHeader& header);

/// Returns the journalled shards of this run's part.
std::vector<store::JournalLine> journalled(const GenerateOptions& options);
/// Removes the damaged shards from the journal if `repair`; otherwise throws InputError if there are any.
void settle(const std::filesystem::path& folder, const std::vector<store::BadShard>& bad, bool repair);
/// Writes the index of a complete dataset (index.hpp).
void finish(const GenerateOptions& options);
/// Returns the missing shards of this run's part.
std::deque<std::uint64_t> missing_shards(const GenerateOptions& options, const store::DatasetHeader& header);

}  // namespace swingbank::mpi::ranks
