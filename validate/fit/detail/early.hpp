#pragma once
// Start states of a fit for events whose response diverges from the record because of a wrong switching time.
#include "validate/fit/fit.hpp"

namespace swingbank::validate::fit::fitting {

/// Returns the start states of all events; empty: all start at the switching times of their FitEvent. If the
/// response of an event diverges, its switching times are first fitted to the record up to shortly after the
/// last switching. Otherwise the search fails: a plant with integral control hardly recovers from a wrong
/// switching time, because the played-in voltage does not respond to the plant. An error of 1 ms may change Q
/// ten seconds later by more than the machine's rating.
std::vector<EventState> early_states(const sim::plant::PlantUnderTest& tested,
                                     const noise::WhitenedEvents& events, const FitOptions& options);

}  // namespace swingbank::validate::fit::fitting
