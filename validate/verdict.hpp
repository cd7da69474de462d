#pragma once
// The verdict in one word and one sentence.
#include "validate/diagnose.hpp"

namespace swingbank::validate {

/// Fills verdict, side, sentence, effects and their rivals from base, inputs and ranking, all judged. Where
/// neither the model nor a known effect stands, laws are searched.
void settle(const Unexplained& judged, const LawProgress& progress, Diagnosis& d);

}  // namespace swingbank::validate
