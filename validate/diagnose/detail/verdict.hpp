#pragma once
// The verdict in one word and one sentence.
#include "validate/diagnose/diagnose.hpp"

namespace swingbank::validate::diagnose {

/// Fills verdict, side, sentence, effects and their rivals from base, inputs and ranking, all of which are
/// judged. Searches for laws where neither the model nor a known effect explains the records.
void settle(const laws::Unexplained& judged, const laws::LawProgress& progress, Diagnosis& d);

}  // namespace swingbank::validate::diagnose
