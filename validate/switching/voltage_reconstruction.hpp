#pragma once
// Reconstruction of the voltage around switchings from samples that an instrument's filter has averaged. The
// averaging window is one of a few known windows.
#include <vector>

#include "validate/switching/filter_window.hpp"
#include "validate/switching/switching.hpp"

namespace swingbank::validate::switching {

/// Returns time, V and theta of the samples that are not filtered.
record::Record without(const record::Record& record, const std::vector<char>& filtered_samples);

/// Returns whether the samples around the switchings are most probable with a known window longer than a
/// sample interval. A shorter window cannot be distinguished from no window. The switchings of the events
/// must have been found with StepShape::filtered.
bool passed_filter(const std::vector<SwitchedRecord>& events);

/// Finds the window with the largest evidence from the samples around all switchings (ReconstructedCurve), a
/// single window for all events. Finds the switching times that the user has not given. Marks the samples
/// within this window as filtered, and adds the reconstructed voltage to the events' clean records, so that
/// every segment between switchings has a voltage. If the instrument's window is none of the known ones, a
/// larger roughness (ReconstructedCurve) compensates for the difference. Returns the window; its half-width
/// is 0 if nothing is filtered.
FilterWindow reconstruct_voltage(std::vector<SwitchedRecord>& events);

}  // namespace swingbank::validate::switching
