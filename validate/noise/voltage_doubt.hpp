#pragma once
// Residual shapes of errors of the played-in voltage, which add to the variance of an error map.
#include "validate/noise/whitened_events.hpp"

namespace swingbank::validate::noise {

/// Shapes of the residual that errors of the played-in voltage cause in an event's channels, one standard
/// deviation each. Two shapes are for errors of the pre-event means of V and theta. A number of random draws,
/// which share the variance, are for the voltage noise behind the plant. Two shapes are for each sample near
/// a switching or in place of a filtered sample, where the voltage is interpolated. The plant is linearised
/// about the start.
struct VoltageDoubt {
  using Shape = std::vector<std::vector<double>>;  ///< [channel][sample]
  std::vector<Shape> shapes;                       ///< each one standard deviation
};
/// Computes the shapes of one event.
VoltageDoubt voltage_doubt(const sim::plant::PlantUnderTest& tested, WhitenedEvent event);

}  // namespace swingbank::validate::noise
