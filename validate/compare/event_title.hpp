#pragma once
// The kind of an event in a few words, for headings: "fault at 2.000 s, 100 ms".
#include <string>

#include "validate/compare/compare.hpp"

namespace swingbank::validate::compare {

/// Returns the fault, the other switchings or the change of frequency that the record shows.
std::string event_title(const EventComparison& e);

}  // namespace swingbank::validate::compare
