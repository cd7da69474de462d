#pragma once
// Events at rest, and with noise of the voltage only, for the response of a plant to that noise.
#include <Eigen/Dense>

#include "validate/event/fit_event.hpp"

namespace swingbank::validate::noise {

/// Returns an event of `seconds` [s] at the operating point of `like`, with zeros as measured channels.
event::FitEvent at_rest(const event::FitEvent& like, double seconds);

/// Returns an event of one minute at the operating point of `like`. V and theta have noise of these variances
/// (VoltageNoise); measured channels are zero.
event::FitEvent minute_of_noise(const event::FitEvent& like, const Eigen::Vector3d& variance);

}  // namespace swingbank::validate::noise
