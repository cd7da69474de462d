#pragma once
// JSON Schema (draft 7) of a TOML file, derived from the function that reads it.
#include <functional>
#include <string>

#include "base/config.hpp"

namespace swingbank {

/// Returns the JSON Schema, as text, of the files that `read` accepts. The schema contains each key with
/// type, range, allowed words, unit, meaning and default, and the keys that other keys require or exclude.
/// `read` is called many times with a config without a file. The calls vary which keys are present and which
/// words are their values. Therefore `read` must read its keys regardless of other problems, and open no
/// file. Conditions that `read` checks by Config::problem() are not part of the schema.
std::string describe_keys(const std::string& title, const std::function<void(Config&)>& read);

}  // namespace swingbank
