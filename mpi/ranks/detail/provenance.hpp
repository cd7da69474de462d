#pragma once
// Who makes a dataset: what its card and its list of attempts say of the software and the machine.
#include <map>
#include <string>

#include "mpi/ranks/generate.hpp"

namespace swingbank::mpi::ranks {

/// Software, compiler, MPI, HDF5, host, processor, system: by name.
std::map<std::string, std::string> made_by(const std::string& software);
/// What a run says of itself when it begins: host, process, ranks, part, job, and what it found.
std::map<std::string, std::string> attempt_of(const GenerateOptions& options, int ranks,
                                              std::size_t journalled, std::size_t bad);

}  // namespace swingbank::mpi::ranks
