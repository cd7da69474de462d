#pragma once
// Provenance of a dataset: software and machine, for its card (card.json) and its log of runs
// (attempts.jsonl).
#include <map>
#include <string>

#include "mpi/ranks/generate.hpp"

namespace swingbank::mpi::ranks {

/// Returns software, compiler, MPI, HDF5, host, processor and operating system, by name.
std::map<std::string, std::string> made_by(const std::string& software);
/// Returns the description of a run at its start: software, host, process, ranks, part, Slurm job, and the
/// shards found and to be repaired.
std::map<std::string, std::string> attempt_of(const GenerateOptions& options, int ranks,
                                              std::size_t journalled, std::size_t bad);

}  // namespace swingbank::mpi::ranks
