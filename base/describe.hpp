#pragma once
// JSON Schema (draft 7) of a TOML file, derived from the function that reads it.
#include <functional>
#include <string>

#include "base/config.hpp"

namespace swingbank {

/// Returns the JSON Schema, as text, of the files that `read` accepts: their keys with types, ranges, words,
/// units, meanings and defaults, and which keys others require or exclude. `read` is called many times with a
/// config without a file, whose keys are present or missing, and whose words change, in turn. Therefore it
/// must ask for every key that it may read, regardless of other problems, and open no file. Conditions that
/// it checks by Config::problem() are not part of the schema.
std::string describe_keys(const std::string& title, const std::function<void(Config&)>& read);

}  // namespace swingbank
