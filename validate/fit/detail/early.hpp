#pragma once
// Start states of a fit for events whose response diverges from the record because of a wrong switching time.
#include "validate/fit/fit.hpp"

namespace swingbank::validate::fit::fitting {

/// Returns the start states of all events; empty: all start at the switching times of their FitEvent. A plant
/// with integral control hardly recovers from a wrong switching time, because the played-in voltage does not
/// respond to it. An error of 1 ms changes Q by more than the machine's rating ten seconds later, and no
/// search step corrects so large a change. In such an event, the switching times are first fitted to the
/// record up to shortly after the last switching.
std::vector<EventState> early_states(const sim::plant::PlantUnderTest& tested,
                                     const noise::WhitenedEvents& events, const FitOptions& options);

}  // namespace swingbank::validate::fit::fitting
