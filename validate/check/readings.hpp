#pragma once
// Readings of a record that playback distinguishes: the angle mirrored, P and Q late, of one phase, with
// other signs. Each is played into the model; one that fits much better is reported, and the record stays as
// it is.
#include <optional>

#include "validate/check/check.hpp"

namespace swingbank::validate::check {

/// The reading under which the model follows P and Q at least three times closer than it follows the record
/// as it is, and to a quarter of their movement. A warning; it refuses only where the model cannot follow the
/// record at all. None where the model follows it already, or no reading is much better: then the model may
/// be wrong.
std::optional<Finding> better_reading(const record::Record& record, const plant::PlantModel& model);

}  // namespace swingbank::validate::check
