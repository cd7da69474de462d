#pragma once
// Phase jumps at switching times, reconstructed for voltage angles integrated from frequency.
#include "sim/plant/under_test.hpp"
#include "validate/event/event.hpp"

namespace swingbank::validate::event {

constexpr double kFarthestTurn = 0.5;  ///< bound of the search [rad]

/// Removes the peaks of f that a step of the angle causes, as wide as the meter's window. Where f around a
/// switching exceeds the prediction from the other samples of the same side, the prediction replaces it, and
/// the angle is integrated again. Samples after a switching, where the prediction is uncertain, are left out.
/// No effect if the angle was measured, or if a filter has spread the voltage, too.
void drop_peaks(FitEvent& event);

/// Estimates the turn of the angle at each switching by least squares of P and Q of the next samples,
/// simulated by `tested`. It is a start for a fit: an error of a fifth in a reactance causes an error of a
/// fifth in the turn. No effect if the angle was measured.
void find_turns(const sim::plant::PlantUnderTest& tested, FitEvent& event);

}  // namespace swingbank::validate::event
