#pragma once
// A databank on the disk: drawn once, read by whoever simulates its points (docs/formats.md).
#include <filesystem>

#include "mpi/draw/databank.hpp"

namespace swingbank::mpi::draw {

/// XXH3-64 over the values, 16 hex digits.
std::string values_hash(const Databank& bank);

/// `base`: as for draw_databank. Throws InputError.
void write_databank(const std::filesystem::path& file, const Databank& bank, const DatasetConfig& config,
                    const sim::plant::Plant& base);

/// The first `points` points. Throws InputError if the file was drawn for a config that draws others, holds
/// fewer, or is not what was written.
Databank read_databank(const std::filesystem::path& file, const DatasetConfig& config,
                       const sim::plant::Plant& base, std::uint64_t points);

}  // namespace swingbank::mpi::draw
