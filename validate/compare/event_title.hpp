#pragma once
// What a record holds, in words: the kind of its event, for headings ("fault at 2.000 s, 100 ms"), and a
// quiet end.
#include <string>

#include "validate/compare/compare.hpp"

namespace swingbank::validate::compare {

/// Returns the fault, the other switchings or the change of frequency that the record shows.
std::string event_title(const EventComparison& e);
/// Returns a hint of --until where much of the record comes long after its last switching; otherwise nothing.
std::string quiet_end_hint(const EventComparison& e);

}  // namespace swingbank::validate::compare
