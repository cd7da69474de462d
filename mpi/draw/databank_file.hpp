#pragma once
// Databank file, written once and read by all programs that simulate its samples (docs/reference/formats.md).
#include <filesystem>

#include "mpi/draw/databank.hpp"

namespace swingbank::mpi::draw {

/// Returns the XXH3-64 hash of the values, 16 hex digits.
std::string values_hash(const Databank& bank);

/// Writes a databank. `base`: as for draw_databank. Throws InputError on failure.
void write_databank(const std::filesystem::path& file, const Databank& bank, const DatasetConfig& config,
                    const sim::plant::Plant& base);

/// Returns the first `points` samples of a file. Throws InputError if the file was drawn for another config,
/// has too few samples, or its checksum is wrong.
Databank read_databank(const std::filesystem::path& file, const DatasetConfig& config,
                       const sim::plant::Plant& base, std::uint64_t points);

}  // namespace swingbank::mpi::draw
