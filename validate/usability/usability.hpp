#pragma once
// Usability of a plant model in a study: initialisation, drift without a disturbance, and damping after a
// small step. The plant is connected to an infinite bus through a reactance.
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/complex.hpp"
#include "validate/plant/plant_model.hpp"

namespace swingbank::validate::usability {

/// Conditions of the check. They are not limits, and are printed with the result.
constexpr double kStudyReactance = 0.2;  ///< between the plant and the infinite bus [pu on the plant's MVA]
constexpr double kStudyDuration = 10;    ///< length of each run [s]
constexpr double kSampleError = 1e-7;    ///< accumulated error of a simulated sample [pu on the plant's MVA]
constexpr double kStudyStep = 0.01;      ///< step of the reference, or of the Thévenin voltage [pu]

/// Operating point before one event.
struct OperatingState {
  std::string event;    ///< name of its record
  Complex voltage;      ///< at the plant's grid side [pu]
  double P = 0, Q = 0;  ///< out of the plant [MW], [Mvar]
};

/// Oscillation of P and Q after the step.
struct Oscillation {
  double frequency = 0;  ///< [Hz]
  double damping = 0;    ///< damping ratio: -real part / magnitude of its eigenvalue [-]
  double amplitude = 0;  ///< larger one of the amplitudes of P and Q just after the step [% of MVA]
};
/// Result at one operating point.
struct UsabilityAt {
  OperatingState state;      ///< operating point
  std::string failure;       ///< why the model does not initialise or cannot be simulated; empty: no failure
  bool initialises = false;  ///< every state is in equilibrium and within its limits
  double drift_P = 0, drift_Q = 0;  ///< largest deviation from the start without a disturbance [% of MVA]
  std::optional<Oscillation> oscillation = {};  ///< the least damped one after the step; none: no oscillation
  bool damped = false;                          ///< synchronism is kept, and the response decays
};
/// Result for all operating points.
struct Usability {
  std::vector<UsabilityAt> at;  ///< one entry for each operating point
  std::string step;             ///< "step of the reference of SEXS by +0.01 pu"
  std::string not_checked;      ///< reason why nothing was checked; empty: checked
  /// Returns the verdict in at most eight words.
  [[nodiscard]] std::string verdict() const;
  /// Returns whether the model initialises and its response is damped at every operating point.
  [[nodiscard]] bool usable() const;
};

/// Simulates the plant from each operating point, without a disturbance and with a small step, by the
/// reference integrator. The step is that of the voltage reference if the plant has an exciter or a plant
/// control, otherwise the switching of a shunt reactor. Instrument models and reference changes of the
/// records are not simulated. A part of a plant (component) is not checked.
Usability check_usability(const plant::PlantModel& model, const std::vector<OperatingState>& states);

/// Returns the least damped oscillation of uniformly sampled signals [signal][sample] of one system, by the
/// matrix pencil method (Y. Hua, T. K. Sarkar, IEEE Trans. ASSP 38 (1990) 814). `rate`: samples per second;
/// `accuracy`: error of a sample. The amplitude has the signals' unit. An oscillation counts if its amplitude
/// exceeds this error, and its energy exceeds the energy of the decomposition's residual. Empty if there is
/// none.
std::optional<Oscillation> least_damped_oscillation(const std::vector<std::vector<double>>& signals,
                                                    double rate, double accuracy);

/// Returns the result as JSON.
nlohmann::json usability_json(const Usability& usability);

}  // namespace swingbank::validate::usability
