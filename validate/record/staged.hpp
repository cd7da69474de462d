#pragma once
// To which record a staged event of a plant file belongs.
#include "validate/record/record.hpp"

namespace swingbank::validate::record {

/// Whether it is one of this file's, by its name or of all.
bool belongs_to(const StagedEvent& e, const std::filesystem::path& file);

}  // namespace swingbank::validate::record
