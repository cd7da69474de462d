#pragma once
// Two hypotheses explain the records as well: what would tell them apart?
#include <string>

#include "validate/judge.hpp"

namespace swingbank::validate {

/// A sentence: which channel that was not recorded would, or which kind of event; what neither would if so.
/// Both are fitted to `events`, so their answers in P and Q are alike; their speed, Efd and Ifd need not be.
std::string what_would_decide(const Judgement& x, const Judgement& y, const std::vector<FitEvent>& events);

}  // namespace swingbank::validate
