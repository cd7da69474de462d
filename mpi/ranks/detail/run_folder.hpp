#pragma once
// The folder of a dataset before a run makes shards: whose it is, what an earlier run left, what is missing.
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "base/run_lock.hpp"
#include "mpi/ranks/generate.hpp"

namespace swingbank::mpi::ranks {

/// What a run holds until it ends: the folder, alone or shared with other parts, and its own part.
struct FolderLocks {
  std::unique_ptr<RunLock> folder, part;
  /// In a folder that is refused.
  void withdraw() {
    folder->withdraw();
    if (part) part->withdraw();
  }
};

/// Locks the folder, makes it this run's, with its header and what `furnish` adds while no other part looks,
/// and removes what a killed run left. Throws InputError where it is in use or another's.
FolderLocks enter(const GenerateOptions& options, const store::DatasetHeader& header,
                  const std::function<void()>& furnish);

/// Whether the folder holds a dataset and cannot be written to. What is complete need not be.
bool is_archive(const std::filesystem::path& folder);
void require_same_config(const std::filesystem::path& folder, const store::DatasetHeader& header);

/// Shards that an earlier run made, of this run's part.
std::vector<store::JournalLine> journalled(const GenerateOptions& options);
/// Bad shards are taken out of the journal, or refused.
void settle(const std::filesystem::path& folder, const std::vector<store::BadShard>& bad, bool repair);
/// Writes what is made of a whole dataset (index.hpp), if it is whole.
void finish(const GenerateOptions& options);
/// Shards still to make.
std::deque<std::uint64_t> missing_shards(const GenerateOptions& options, const store::DatasetHeader& header);

}  // namespace swingbank::mpi::ranks
