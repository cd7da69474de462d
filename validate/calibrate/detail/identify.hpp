#pragma once
// What the records cannot tell, and which event could.
#include "validate/calibrate/calibrate.hpp"
#include "validate/fit/noise.hpp"
#include "validate/fit/slopes.hpp"

namespace swingbank::validate::calibrate {

/// Directions of the information matrix (in units of belief) that the records decide less than half.
/// `unit`: axis_unit of each parameter.
std::vector<Blur> find_blurs(const Eigen::MatrixXd& information, const Eigen::VectorXd& unit);

/// Information of events that were not recorded, made by driving the plant with plain voltages: a frequency
/// event, a deep fault, a lasting step of the voltage. Where speed, Efd and Ifd were not recorded, the same
/// events with them follow. `voltage` is the played-in voltage's noise.
struct TriedEvent {
  std::string what;
  Eigen::MatrixXd information;
};
std::vector<TriedEvent> try_events(const sim::plant::PlantUnderTest& tested,
                                   const event::WhitenedEvents& events,
                                   const std::vector<fit::EventState>& states,
                                   const fit::VoltageNoise& voltage,
                                   const std::vector<fit::FreeParameter>& free);

}  // namespace swingbank::validate::calibrate
