#pragma once
// Identifiability: parameter combinations that the records do not identify, and further events that would
// identify them.
#include "validate/calibrate/calibrate.hpp"
#include "validate/fit/sensitivities.hpp"
#include "validate/noise/voltage_noise.hpp"

namespace swingbank::validate::calibrate {

/// Returns the eigenvectors of the Fisher information matrix (parameters scaled by their prior standard
/// deviations) for which the records contribute less than half of the posterior precision. `unit`:
/// axis_unit() of each parameter.
std::vector<UnidentifiedCombination> find_unidentified(const Eigen::MatrixXd& information,
                                                       const Eigen::VectorXd& unit);

/// Information matrix of an event that was not recorded.
struct TriedEvent {
  std::string what;
  Eigen::MatrixXd information;
};
/// Simulates further events by playback of synthetic voltage signals: a frequency event, a deep fault, a
/// lasting voltage step and a load rejection. If Ifd was not recorded, also evaluates the recorded events as
/// if speed, Efd and Ifd had been measured too. Returns an empty list for component records and staged tests,
/// because their additional inputs (Vref, Pref) are unknown. `voltage` is the noise of the played-in voltage.
std::vector<TriedEvent> try_events(const sim::plant::PlantUnderTest& tested,
                                   const noise::WhitenedEvents& events,
                                   const std::vector<fit::EventState>& states,
                                   const noise::VoltageNoise& voltage,
                                   const std::vector<fit::FreeParameter>& free);

}  // namespace swingbank::validate::calibrate
