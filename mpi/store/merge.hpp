#pragma once
// Merging of datasets of one config that have some of the shards each, generated on machines without a common
// disk.
#include <filesystem>
#include <functional>
#include <vector>

#include "mpi/store/dataset.hpp"

namespace swingbank::mpi::store {

/// Copies the shards that `into` lacks. Each copy is compared with its journal entry, flushed and then
/// journalled, so that an interrupted merge can continue. Calls `done` for each shard. Throws InputError for
/// a folder of another config; and, after all valid shards are copied, for contradictory entries and for
/// every file that differs from its entry.
void merge_datasets(const std::vector<std::filesystem::path>& from, const std::filesystem::path& into,
                    const std::function<void()>& done);

}  // namespace swingbank::mpi::store
