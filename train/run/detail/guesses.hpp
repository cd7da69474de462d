#pragma once
// Estimates of all rows by a method without training, which a network reads and corrects. They are made once
// for a dataset, a noise and a method, and kept in the folder of results.
#include <filesystem>
#include <string>
#include <vector>

#include "train/data/shard_stream.hpp"

namespace swingbank::train::run {

/// All rows of the stream x parameters, raw units. Reads `folder`/guesses-....bin or makes it; another
/// process that is at the same waits. Throws InputError if the file is damaged or the method does not fit the
/// dataset.
std::vector<float> guesses(const data::ShardStream& stream, const std::string& method,
                           const std::filesystem::path& folder, bool quiet);

}  // namespace swingbank::train::run
