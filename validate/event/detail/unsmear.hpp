#pragma once
// Brings back the voltage about switchings that an instrument's filter has smeared. The smeared samples know
// it: each is the average of what lies about it, and the window of the average is one of a few.
#include <vector>

#include "validate/event/detail/filter_window.hpp"
#include "validate/event/event.hpp"

namespace swingbank::validate::event {

/// Time, V and theta of the samples that are not smeared.
record::Record without(const record::Record& record, const std::vector<char>& smeared);

/// Whether the samples about the switchings are most probable behind a known window that is longer than a
/// sample interval; a shorter one cannot be told from none. The events are prepared as if there were one.
bool passed_filter(const std::vector<FitEvent>& events);

/// Finds the window that makes the samples about all switchings most probable (SmearedCurve), one for all
/// events, and the instants of those switchings that nobody told. Marks as smeared what this window reaches,
/// and puts the voltage that was brought back into the events' clean records, so that every segment between
/// switchings has one. Where the instrument has another window than those known, a rougher voltage makes up
/// for it. Returns the window, half = 0 where nothing is smeared.
FilterWindow unsmear(std::vector<FitEvent>& events);

}  // namespace swingbank::validate::event
