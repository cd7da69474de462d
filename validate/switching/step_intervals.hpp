#pragma once
// Sample intervals with a voltage step, also if a filter has spread it.
#include <cstddef>
#include <vector>

#include "validate/record/record.hpp"

namespace swingbank::validate::switching {

/// A sample interval (or two, if a filter spreads the step) with a voltage step.
struct StepInterval {
  std::size_t before, after;  ///< samples
};
/// Finds steps of the voltage phasor, down to the size that exceeds noise and swings.
std::vector<StepInterval> find_steps(const record::Record& record);
/// Returns the steps large enough for a quotient of steps. Excluded are those of small events, and those
/// where the fall and rise of a fault shorter than the filter overlap.
std::vector<StepInterval> find_large_steps(const record::Record& record);

}  // namespace swingbank::validate::switching
