#pragma once
// False-positive rate of the last blind test (docs/reference/blind-test-results.md), which is shown with each
// verdict. It is updated together with this document after new cases, never after inspection of judged cases.
#include <string>

#include "base/rate.hpp"

namespace swingbank::validate::diagnose {

/// Cases without a hidden effect in which an effect was named, judged before any correction based on them:
/// seeds 2873555985 and 1316693824.
inline const Rate kFalsePositives{0, 465};

/// Returns "False positives of the diagnosis: k of n blind cases without a hidden effect (95 % interval
/// ...)."
std::string false_positive_note();

}  // namespace swingbank::validate::diagnose
