#pragma once
// Reconstruction of the voltage around switchings from samples that an instrument's filter has averaged. The
// window of the average is one of a few.
#include <vector>

#include "validate/switching/filter_window.hpp"
#include "validate/switching/switching.hpp"

namespace swingbank::validate::switching {

/// Returns time, V and theta of the samples that are not filtered.
record::Record without(const record::Record& record, const std::vector<char>& filtered_samples);

/// Returns whether the samples around the switchings are most probable with a known window longer than a
/// sample interval; a shorter one cannot be distinguished from none. The events must be prepared for a
/// filter.
bool passed_filter(const std::vector<SwitchedRecord>& events);

/// Finds the window, one for all events, with the largest evidence from the samples around all switchings
/// (ReconstructedCurve), and the switching times that the user has not given. Marks the samples within this
/// window as filtered, and adds the reconstructed voltage to the events' clean records, so that every segment
/// between switchings has a voltage. If the instrument has an unknown window, a larger roughness compensates.
/// Returns the window, half = 0 if nothing is filtered.
FilterWindow reconstruct_voltage(std::vector<SwitchedRecord>& events);

}  // namespace swingbank::validate::switching
