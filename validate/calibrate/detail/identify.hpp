#pragma once
// Identifiability: directions that the records do not determine, and further events that would.
#include "validate/calibrate/calibrate.hpp"
#include "validate/fit/sensitivities.hpp"
#include "validate/noise/voltage_noise.hpp"

namespace swingbank::validate::calibrate {

/// Returns the eigenvectors of the information matrix (per prior standard deviation) whose posterior
/// precision comes from the records by less than half. `unit`: axis_unit() of each parameter.
std::vector<Blur> find_blurs(const Eigen::MatrixXd& information, const Eigen::VectorXd& unit);

/// Information matrix of an event that was not recorded.
struct TriedEvent {
  std::string what;
  Eigen::MatrixXd information;
};
/// Simulates further events by playback of simple voltages: a frequency event, a deep fault, a lasting
/// voltage step and a load rejection. Where Ifd was not recorded, the recorded events with speed, Efd and Ifd
/// follow. Returns none for records of a component other than the plant and for staged tests, whose further
/// inputs would have to be invented. `voltage` is the noise of the played-in voltage.
std::vector<TriedEvent> try_events(const sim::plant::PlantUnderTest& tested,
                                   const noise::WhitenedEvents& events,
                                   const std::vector<fit::EventState>& states,
                                   const noise::VoltageNoise& voltage,
                                   const std::vector<fit::FreeParameter>& free);

}  // namespace swingbank::validate::calibrate
