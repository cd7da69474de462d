#pragma once
// Alternative readings of a record that playback can distinguish: angle mirrored, P and Q delayed, of one
// phase, or with other signs. Each is played into the model; one that fits much better is reported, and the
// record is not changed.
#include <optional>

#include "validate/check/check.hpp"

namespace swingbank::validate::check {

/// Returns the reading whose error of P and Q is at most a third of the error with the unchanged record, and
/// at most a quarter of their movement. It is a warning, and a refusal only if the model cannot follow the
/// record at all. None if the model follows the unchanged record, or if no reading is much better: then the
/// model may be wrong.
std::optional<Finding> better_reading(const record::Record& record, const plant::PlantModel& model);

}  // namespace swingbank::validate::check
