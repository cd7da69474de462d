#pragma once
// Titles of events for headings ("fault at 2.000 s, 100 ms"), and a hint for long quiet ends.
#include <string>

#include "validate/compare/compare.hpp"

namespace swingbank::validate::compare {

/// Returns a title that names the fault, or else staged tests or switchings, and the change of frequency.
std::string event_title(const EventComparison& e);
/// Returns a hint at --until if the record goes on for 120 s or more after its last switching, else nothing.
std::string quiet_end_hint(const EventComparison& e);

}  // namespace swingbank::validate::compare
