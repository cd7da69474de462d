#pragma once
// Phase jumps at switching times, reconstructed for voltage angles integrated from frequency.
#include "sim/plant/under_test.hpp"
#include "validate/event/fit_event.hpp"

namespace swingbank::validate::event {

/// Largest phase jump in a fit of several units at a common measuring point, and largest step of find_turns()
/// [rad].
constexpr double kFarthestTurn = 0.5;

/// Removes the peaks of f that phase jumps cause over the width of the meter's window. If f around a
/// switching deviates from the extrapolation of the samples on the same side, the extrapolation replaces f,
/// and the angle is integrated again. The replaced samples after a switching are not compared, because the
/// extrapolation is uncertain there. No effect if the angle was measured, or if voltage samples are marked as
/// filtered.
void drop_peaks(FitEvent& event);

/// Estimates the phase jump (Switching::turn) at each switching by least squares of P and Q of the next
/// samples, simulated by `tested`; 0 if the simulation fails. The estimate is a start value for a fit: an
/// error of 20 % in a reactance causes an error of 20 % in the phase jump. No effect if the angle was
/// measured.
void find_turns(const sim::plant::PlantUnderTest& tested, FitEvent& event);

}  // namespace swingbank::validate::event
