#pragma once
// Titles of events for headings ("fault at 2.000 s, 100 ms"), and a hint about records that continue long
// after the event.
#include <string>

#include "validate/compare/compare.hpp"

namespace swingbank::validate::compare {

/// Returns a title that names the fault or, without a fault, the staged tests or switchings and the change of
/// frequency.
std::string event_title(const EventComparison& e);
/// Returns a hint to use --until if the record continues for 120 s or more after its last switching;
/// otherwise an empty string.
std::string quiet_end_hint(const EventComparison& e);

}  // namespace swingbank::validate::compare
