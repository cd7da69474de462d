#pragma once
// Estimates of all rows by a method of train/direct, as input of a network that corrects them. They are
// computed once per dataset, noise, method and software, and stored in the results folder.
#include <filesystem>
#include <string>
#include <vector>

#include "train/data/shard_stream.hpp"

namespace swingbank::train::run {

/// Returns the estimates: all rows of the stream x parameters [raw units]. Reads the file
/// `folder`/guesses-....bin, or computes the estimates and writes it; a second process waits for the first.
/// `maker`: software that computes them. Throws InputError if the file is damaged or the method does not
/// apply to the dataset.
std::vector<float> guesses(const data::ShardStream& stream, const std::string& method,
                           const std::string& maker, const std::filesystem::path& folder, bool quiet);

}  // namespace swingbank::train::run
