#pragma once
// Sample intervals that contain a voltage step, also if a filter has spread the step.
#include <cstddef>
#include <vector>

#include "validate/record/record.hpp"

namespace swingbank::validate::switching {

/// Sample interval that contains a voltage step, or several intervals if a filter has spread the step.
struct StepInterval {
  std::size_t before, after;  ///< samples before and after the step
};
/// Finds steps of the voltage phasor, down to the size that exceeds noise and swings. If the user has given
/// switching times, returns the intervals that contain them.
std::vector<StepInterval> find_steps(const record::Record& record);
/// Returns the steps that are large enough to compare the steps of voltage and current, and all given ones.
/// Excluded are steps of small events, and the overlapping steps of a fault that is shorter than the filter's
/// window.
std::vector<StepInterval> find_large_steps(const record::Record& record);

}  // namespace swingbank::validate::switching
