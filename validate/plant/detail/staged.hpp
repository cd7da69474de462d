#pragma once
// Staged tests of a plant file: [[event]] with kind, time, size, until and the record it belongs to.
#include <string>
#include <vector>

#include "base/config.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::plant {

/// Every [[event]] of the file; its faults go to the config.
std::vector<record::StagedEvent> read_staged_events(Config& config);
/// The same as text of a plant file. `number` writes a value to the last digit.
std::string staged_text(const std::vector<record::StagedEvent>& events, std::string (*number)(double));

}  // namespace swingbank::validate::plant
