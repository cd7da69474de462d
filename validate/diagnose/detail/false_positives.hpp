#pragma once
// What the last blind cases measured (docs/blind-test.md), to be said beside each verdict. Changed with the
// document, after new cases; never after a look at cases already judged.
#include <string>

#include "base/rate.hpp"

namespace swingbank::validate::diagnose {

/// Cases in which nothing was hidden that were given an effect, as judged before anything was mended on them:
/// seeds 400997928, 138707171, 1497583896 and 490966968.
inline const Rate kFalsePositives{1, 310};

/// "In k of n blind cases in which nothing was hidden an effect was named (95 %: a to b %)."
std::string false_positive_note();

}  // namespace swingbank::validate::diagnose
