#pragma once
// Shapes of what errors of the played-in voltage may leave in a residual; they add to a map's variance.
#include "validate/event/event.hpp"

namespace swingbank::validate::fit {

/// What the played-in voltage's own errors may leave in an event's channels, as shapes of one standard
/// deviation each: two for the errors of the means of V and theta before the event, a number of draws for
/// what their noise becomes behind the plant (the draws share its variance), and two for each sample about a
/// switching or in place of smeared samples, where the voltage is guessed. The plant is linear about the
/// start.
struct VoltageDoubt {
  using Shape = std::vector<std::vector<double>>;  ///< [channel][sample]
  std::vector<Shape> shapes;
};
VoltageDoubt voltage_doubt(const sim::plant::PlantUnderTest& tested, event::WhitenedEvent event);

}  // namespace swingbank::validate::fit
