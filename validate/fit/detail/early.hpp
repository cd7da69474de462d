#pragma once
// Start states of a fit for events whose response diverges from the record because of a wrong switching time.
#include "validate/fit/fit.hpp"

namespace swingbank::validate::fit::fitting {

/// Returns the start states of all events. Empty: all events start at the prepared switching times
/// (FitEvent). If the response of an event diverges, its switching times are first fitted to the record up to
/// shortly after the last switching. Without this fit the search fails. The played-in voltage does not
/// respond to the plant, so a plant with integral control hardly recovers from a wrong switching time. An
/// error of 1 ms may change Q ten seconds later by more than the machine's rating.
std::vector<EventState> early_states(const sim::plant::PlantUnderTest& tested,
                                     const noise::WhitenedEvents& events, const FitOptions& options);

}  // namespace swingbank::validate::fit::fitting
