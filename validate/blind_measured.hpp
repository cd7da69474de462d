#pragma once
// What the blind test measured of the diagnosis as it stands (docs/blind-test.md), to be said beside each
// verdict. Changed with the document, after a scoring.
#include <string>

#include "validate/blind_score.hpp"

namespace swingbank::validate {

/// Cases in which nothing was hidden that were given an effect.
inline const Rate kFalsePositives{1, 4};

/// "Of N blind cases in which nothing was hidden k were given an effect (95 %: a to b %)."
std::string false_positive_note();

}  // namespace swingbank::validate
