#pragma once
// Reads the shards of a dataset on several cores and says which cannot be trusted. Needs no MPI: HDF5 lets
// one thread in at a time, so processes of this program read them.
#include <functional>
#include <string>

#include "mpi/store/dataset.hpp"

namespace swingbank::mpi::store {

/// A bad shard as a line of text that another process can read, and back.
std::string bad_shard_text(const BadShard& bad);
BadShard parse_bad_shard(const std::string& text);

/// Looks at each shard of the journal with fault_of, in `processes` processes (1: here). `done` is called
/// after each. Returns the bad ones in order of shard number. No thread may have been started before.
std::vector<BadShard> bad_shards(
    const std::filesystem::path& folder, const DatasetHeader& header, const std::vector<JournalLine>& lines,
    int processes, const std::function<void()>& done = [] {});

/// The same with one process. Throws InputError with every shard at fault.
void verify_dataset(const Dataset& dataset);

}  // namespace swingbank::mpi::store
