#pragma once
// Alternative interpretations of a record, tested by playback: other signs, delayed or exchanged P and Q,
// power of one phase. An interpretation that fits much better is reported; the record is not changed.
#include <optional>

#include "validate/check/check.hpp"

namespace swingbank::validate::check {

/// Returns the best interpretation as a warning. Its RMS error of P and Q is at most a third of the error
/// with the unchanged record, and at most a quarter of their movement. The finding is a refusal if playback
/// of the unchanged record fails. Returns none if the model follows the unchanged record, or if no
/// interpretation is much better; in the latter case the model may be wrong.
std::optional<Finding> better_reading(const record::Record& record, const plant::PlantModel& model);

}  // namespace swingbank::validate::check
