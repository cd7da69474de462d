#pragma once
// Checkpoint of a training run as a checksummed file.
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

namespace swingbank::train::loop {

/// Writes a checkpoint. header: position and identity of the run; arrays: weights, moments, best weights and
/// averaged weights (if used), in a fixed order.
void write_checkpoint(const std::filesystem::path& file, const nlohmann::json& header,
                      const std::vector<std::span<const float>>& arrays);
/// Reads a checkpoint into `arrays` of matching lengths. Returns false if there is no such file. Throws
/// InputError if it is damaged, belongs to another run (header["run"] differs from `run`), or has arrays of
/// other lengths.
bool read_checkpoint(const std::filesystem::path& file, const nlohmann::json& run, nlohmann::json& header,
                     const std::vector<std::span<float>>& arrays);

}  // namespace swingbank::train::loop
