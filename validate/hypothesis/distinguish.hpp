#pragma once
// What would tell two hypotheses apart that explain the records as well.
#include <string>

#include "validate/hypothesis/judge.hpp"

namespace swingbank::validate::hypothesis {

/// A sentence that names the channel that was not recorded, or the kind of event, that would tell the two
/// apart, or says that none would. Both are fitted to `events`, so their answers in P and Q are alike; their
/// speed, Efd and Ifd need not be.
std::string what_would_decide(const Judgement& x, const Judgement& y, const event::WhitenedEvents& events);

}  // namespace swingbank::validate::hypothesis
