#pragma once
// Assignment of a plant file's staged events to records.
#include "validate/record/record.hpp"

namespace swingbank::validate::record {

/// Returns whether the event applies to this file, by name or because it applies to all.
bool belongs_to(const StagedEvent& e, const std::filesystem::path& file);

}  // namespace swingbank::validate::record
