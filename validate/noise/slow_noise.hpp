#pragma once
// Voltage noise transferred through the plant: state-space model and innovations filter.
#include <memory>

#include "sim/plant/under_test.hpp"
#include "validate/noise/voltage_noise.hpp"

namespace swingbank::validate::noise {

/// Returns the state-space model of the voltage noise transferred through the plant. Its states are the
/// plant's states, without the effect of the latest sample, and the errors of the pre-event means of V and
/// theta. All deviations refer to these means. `event` supplies whitening, channels and start.
SlowNoise slow_noise(const playin::LinearPlant& plant, WhitenedEvent event, const VoltageNoise& voltage);

/// Returns the innovations filter of an event's noise; null if the slow noise is negligible. The filter is
/// computed from slow_noise() of the plant linearised about the event's start.
std::shared_ptr<const Innovations> memory_of(const sim::plant::PlantUnderTest& tested, WhitenedEvent event,
                                             const VoltageNoise& voltage);

}  // namespace swingbank::validate::noise
