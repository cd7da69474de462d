#pragma once
// What the errors of the played-in voltage may leave in a residual, as shapes that add to a map's variance.
#include "validate/fit_event.hpp"

namespace swingbank::validate {

/// What the played-in voltage's own errors leave in an event's channels, one standard deviation each: its
/// mean's before the event, what its noise becomes behind the plant (draws of it, which share the variance),
/// and what it may be off by about switchings and in place of smeared samples. The plant is linear about the
/// start.
struct VoltageDoubt {
  using Shape = std::vector<std::vector<double>>;  ///< [channel][sample]
  std::vector<Shape> shapes;
};
VoltageDoubt voltage_doubt(const sim::Plant& plant, const sim::Conventions& conventions,
                           const FitEvent& event);

}  // namespace swingbank::validate
