#pragma once
// Errors for keys of a TOML table that its reader does not know.
#include <string>
#include <vector>

#include "base/config.hpp"

namespace swingbank::validate::plant {

/// Adds a problem for each key of the table `at` that is not in `known`, with the most similar known key.
/// `name`: the table in the message, "[[limiter]]".
void refuse_unknown_keys(Config& config, const std::string& at, const std::string& name,
                         const std::vector<std::string>& known);

}  // namespace swingbank::validate::plant
