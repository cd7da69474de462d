#pragma once
// Where a search begins in an event whose answer runs away from its instants.
#include "validate/fit/fit.hpp"

namespace swingbank::validate::fit::fitting {

/// Driven by its own voltage, a plant that regulates through integrals hardly comes back: a millisecond of an
/// instant moves Q ten seconds later by more than the machine is large, and no step of a search follows that
/// far. In such an event instants and start are fitted to its first part alone, until shortly after the last
/// switching. Returns the states to begin with; empty where all events begin as they were prepared.
std::vector<EventState> early_states(const sim::plant::PlantUnderTest& tested,
                                     const event::WhitenedEvents& events, const FitOptions& options);

}  // namespace swingbank::validate::fit::fitting
