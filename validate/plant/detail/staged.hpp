#pragma once
// Staged tests of a plant file: [[event]] with kind, time, size, until and the record that it applies to.
#include <string>
#include <string_view>
#include <vector>

#include "base/config.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::plant {

/// Reads every [[event]] of the file. Problems are added to the config.
std::vector<record::StagedEvent> read_staged_events(Config& config);
/// Returns the events as text of a plant file; `quoted` formats a text as a TOML string, `number` a value
/// exactly.
std::string staged_text(const std::vector<record::StagedEvent>& events,
                        std::string (*quoted)(std::string_view), std::string (*number)(double));

}  // namespace swingbank::validate::plant
