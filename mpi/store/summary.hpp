#pragma once
// Summary of a dataset and of its runs as text.
#include <string>

#include "mpi/store/dataset.hpp"

namespace swingbank::mpi::store {

/// Returns the text with the runs on a dataset and their outcomes; empty if there is no log.
std::string describe_attempts(const std::filesystem::path& folder);

/// Returns the text with a dataset's rows, size on disk, draws by outcome and hash.
std::string describe(const Dataset& dataset);

}  // namespace swingbank::mpi::store
