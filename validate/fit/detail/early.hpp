#pragma once
// Start states of a fit for events whose response diverges from the record because of a wrong switching time.
#include "validate/fit/fit.hpp"

namespace swingbank::validate::fit::fitting {

/// Returns the start states of all events; empty: all as prepared. A plant with integral control hardly
/// recovers from a wrong switching time when its own voltage is played in. One millisecond changes Q ten
/// seconds later by more than the machine's rating, and no step of a search follows that far. In such an
/// event, the switching times are first fitted to the record up to shortly after the last switching.
std::vector<EventState> early_states(const sim::plant::PlantUnderTest& tested,
                                     const noise::WhitenedEvents& events, const FitOptions& options);

}  // namespace swingbank::validate::fit::fitting
