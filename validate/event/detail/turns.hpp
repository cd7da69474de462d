#pragma once
// Turns of an angle that was integrated from a frequency, which shows a jump late, smoothed or not at all.
#include "sim/plant/under_test.hpp"
#include "validate/event/event.hpp"

namespace swingbank::validate::event {

constexpr double kFarthestTurn = 0.5;  ///< of a search [rad]

/// A meter shows the jump of an angle as a peak of f, spread over its own window. Where f stands out about
/// the switchings from what its other samples foretell, it is taken from these, on each side from its own,
/// and the angle is integrated again; samples behind a switching, where it is a guess, are left out. Nothing
/// where the angle was measured, or a filter has smeared the voltage too.
void drop_peaks(FitEvent& event);

/// Turns the angle at each switching to where P and Q of the next samples are met best by `tested`; nothing
/// where the angle was measured. It is a start: a reactance that is wrong by a fifth makes it wrong by as
/// much.
void find_turns(const sim::plant::PlantUnderTest& tested, FitEvent& event);

}  // namespace swingbank::validate::event
