#pragma once
// Summary of a dataset as text.
#include <string>

#include "mpi/store/dataset.hpp"

namespace swingbank::mpi::store {

/// Returns the runs on a dataset with their outcomes; empty if there is no log.
std::string describe_attempts(const std::filesystem::path& folder);

/// Returns rows, size on disk, draws by outcome and hash of a dataset.
std::string describe(const Dataset& dataset);

}  // namespace swingbank::mpi::store
