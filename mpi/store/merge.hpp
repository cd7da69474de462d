#pragma once
// Joins datasets of one config, each with some of the shards, into one: where parts were made on machines
// that share no disk.
#include <filesystem>
#include <functional>
#include <vector>

#include "mpi/store/dataset.hpp"

namespace swingbank::mpi::store {

/// Copies what `into` lacks; each copy is compared with its journal line, flushed, and then journalled, so
/// that a merge that was killed goes on. `done` is called for each shard looked at. Throws InputError naming
/// the folder of another config, two journals that say different things of a shard, and every file that is
/// not as its journal says; what is whole is copied all the same.
void merge_datasets(const std::vector<std::filesystem::path>& from, const std::filesystem::path& into,
                    const std::function<void()>& done);

}  // namespace swingbank::mpi::store
