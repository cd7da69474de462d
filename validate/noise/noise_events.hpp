#pragma once
// Synthetic events with constant or noisy voltage, for the response of a plant to voltage noise.
#include <Eigen/Dense>

#include "validate/event/fit_event.hpp"

namespace swingbank::validate::noise {

/// Returns an event of `seconds` [s] in steady state at the operating point of `like`. Measured channels are
/// zero; a component record contains the initial values.
event::FitEvent at_rest(const event::FitEvent& like, double seconds);

/// Returns at_rest() for one minute, with noise of these variances in V and theta (VoltageNoise).
event::FitEvent minute_of_noise(const event::FitEvent& like, const Eigen::Vector3d& variance);

}  // namespace swingbank::validate::noise
