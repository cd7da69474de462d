#pragma once
// Noise of the played-in voltage behind the plant: state-space model and innovations filter.
#include <memory>

#include "sim/plant/under_test.hpp"
#include "validate/noise/voltage_noise.hpp"

namespace swingbank::validate::noise {

/// Returns the state-space model of the voltage's noise behind the plant. Its states are those of the plant,
/// without the effect of the latest sample, and the mean error of V and theta before the event. All
/// deviations refer to that mean. `event` supplies whitening, channels and start.
SlowNoise slow_noise(const playin::LinearPlant& plant, WhitenedEvent event, const VoltageNoise& voltage);

/// Returns the innovations filter of an event's noise, from slow_noise() about its start; null if slow noise
/// is negligible.
std::shared_ptr<const Innovations> memory_of(const sim::plant::PlantUnderTest& tested, WhitenedEvent event,
                                             const VoltageNoise& voltage);

}  // namespace swingbank::validate::noise
