#pragma once
// The verdict in one word and one sentence.
#include "validate/diagnose.hpp"

namespace swingbank::validate {

/// Fills verdict, side, sentence, effects and their rivals from base, inputs and ranking, all of which are
/// judged. Searches for laws where neither the model nor a known effect explains the records.
void settle(const Unexplained& judged, const LawProgress& progress, Diagnosis& d);

}  // namespace swingbank::validate
