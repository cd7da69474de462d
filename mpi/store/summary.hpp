#pragma once
// What a dataset holds, for people.
#include <string>

#include "mpi/store/dataset.hpp"

namespace swingbank::mpi::store {

/// Rows, draws by outcome, size on disk, hash.
std::string describe(const Dataset& dataset);

}  // namespace swingbank::mpi::store
