#pragma once
// Time series of the residual that errors of the played-in voltage cause. They add to the variance in an
// error map.
#include "validate/noise/whitened_events.hpp"

namespace swingbank::validate::noise {

/// Shapes of the residual that errors of the played-in voltage cause in an event's channels, one standard
/// deviation each. The plant is linearised about the start. Two shapes are for errors of the pre-event means
/// of V and theta. Random realisations, whose variances add up to that of the noise, represent the voltage
/// noise transferred through the plant. Two shapes (V and theta) are for each sample interval that contains a
/// switching, and for each reconstructed sample.
struct VoltageDoubt {
  using Shape = std::vector<std::vector<double>>;  ///< [channel][sample]
  std::vector<Shape> shapes;                       ///< each one standard deviation
};
/// Computes the shapes of one event.
VoltageDoubt voltage_doubt(const sim::plant::PlantUnderTest& tested, WhitenedEvent event);

}  // namespace swingbank::validate::noise
