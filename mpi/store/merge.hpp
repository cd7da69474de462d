#pragma once
// Merging of partial datasets of one config, generated on machines without a shared file system.
#include <filesystem>
#include <functional>
#include <vector>

#include "mpi/store/dataset.hpp"

namespace swingbank::mpi::store {

/// Copies the shards that `into` lacks. Each copy is compared with its journal entry, flushed and then
/// journalled, so that an interrupted merge can continue. Calls `done` for each shard.
/// Ends early after a stop signal. Throws InputError for
/// a folder of another config. After all valid shards are copied, throws InputError for contradictory entries
/// and for files that differ from their entries.
void merge_datasets(const std::vector<std::filesystem::path>& from, const std::filesystem::path& into,
                    const std::function<void()>& done);

}  // namespace swingbank::mpi::store
