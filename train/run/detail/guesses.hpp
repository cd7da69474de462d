#pragma once
// Untrained estimates of all rows, as input of a network that corrects them. Computed once per dataset, noise
// and method, and kept in the results folder.
#include <filesystem>
#include <string>
#include <vector>

#include "train/data/shard_stream.hpp"

namespace swingbank::train::run {

/// Returns all rows of the stream x parameters [raw units]. Reads `folder`/guesses-....bin or creates it; a
/// second process waits for the first. Throws InputError if the file is damaged or the method does not apply
/// to the dataset.
std::vector<float> guesses(const data::ShardStream& stream, const std::string& method,
                           const std::filesystem::path& folder, bool quiet);

}  // namespace swingbank::train::run
