#pragma once
// What a dataset holds, for people.
#include <string>

#include "mpi/store/dataset.hpp"

namespace swingbank::mpi::store {

/// Rows, draws by outcome, size on disk, hash.
/// What became of the runs that made it; empty where none was written down.
std::string describe_attempts(const std::filesystem::path& folder);

std::string describe(const Dataset& dataset);

}  // namespace swingbank::mpi::store
