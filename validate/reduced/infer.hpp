#pragma once
// Inference of the torque and the field voltage that the records imply, as time series added to Tm and Efd of
// the model. They are estimated together with the parameters of the submitted model and with the initial
// state and switching times of each event. The free inputs replace whatever the controls do wrong, and the
// machine's equations hold, so a few Gauss-Newton steps from the submitted values suffice. The log evidence
// decides which of the two inputs is needed.
#include <Eigen/Dense>
#include <span>
#include <vector>

#include "validate/fit/fit.hpp"

namespace swingbank::validate::reduced {

/// Knots of an event's piecewise linear inputs. An input may have a step at each switching time after the
/// first, where two knots lie one nanosecond apart.
struct Knots {
  std::vector<double> t;                     ///< [s]
  std::vector<std::size_t> discontinuities;  ///< index of the first knot of each such pair
};

/// Whitened residuals of one event (model - measured) and their Jacobians at the point of an Inference:
/// [value][parameter]. Plant parameters are in the search's coordinate z (fit/axis.hpp), the event's state is
/// in the units of the search (fit/states.hpp), inputs are in pu.
struct EventSensitivities {
  Knots knots;                                  ///< knots of the inputs
  Eigen::MatrixXd plant, state, torque, field;  ///< no columns for an input that is not free
  Eigen::MatrixXd changes;                      ///< columns of add_changes()
  /// Posterior standard deviations of the inputs at the knots [pu]; set by infer_smooth() only.
  Eigen::VectorXd torque_deviation, field_deviation;  ///< [knot]
  Eigen::VectorXd residual;                           ///< [value], model - measured, whitened
  Eigen::VectorXd state_at;                           ///< estimate of the state, in the units of the search
};

/// Selects the free inputs.
struct Inputs {
  bool torque = false, field = false;  ///< whether the torque and the field voltage are free
};

/// Result of an inference: inputs, parameters and event states, with residuals and Jacobians at that point.
struct Inference {
  Inputs inputs;  ///< free inputs
  /// `base`: the submitted plant with the estimated values. `plant`: the simulated plant, which may have an
  /// additional block.
  sim::plant::Plant base, plant;           ///< submitted and simulated plant
  std::vector<fit::FreeParameter> free;    ///< free parameters of `base`
  Eigen::VectorXd offset;                  ///< free parameters minus their prior means, in z
  std::vector<event::EventState> states;   ///< states of the events, including the free inputs
  std::vector<EventSensitivities> events;  ///< residuals and Jacobians of the events
  noise::NoiseModel noise;                 ///< noise model of the residuals
  double chi2 = 0;                         ///< sum of squared whitened residuals
  /// -2 log evidence by Laplace's approximation, up to a constant common to all inferences of these events.
  double criterion = 0;
  int values = 0, steps = 0;  ///< number of compared values; number of Gauss-Newton steps
  /// Returns the reduced chi-square: chi2 divided by the number of compared values [-].
  [[nodiscard]] double reduced_chi2() const { return chi2 / values; }
};

/// A change of the simulated plant in quantities that are not free: a parameter leaves the value at which its
/// effect vanishes (null value), or an instrument has an error.
struct Change {
  sim::plant::Plant from, to;  ///< plant before and after the change
};
/// Adds a Jacobian column for each change to an inference: residuals with `to` minus residuals with `from`,
/// at the states of the inference. A column is zero if one of the two plants cannot be simulated.
void add_changes(Inference& inference, const noise::WhitenedEvents& events,
                 const sim::Conventions& conventions, std::span<const Change> changes, int threads);

/// Prior variance rate of an input's random walk [pu^2/s]. A field voltage may run from one ceiling to the
/// other within a second. A turbine's power changes by about a tenth of its rating in a second.
inline constexpr double kFieldWalk = 1.0, kTorqueWalk = 0.01;  ///< field voltage; torque
/// Returns 1 / prior standard deviation of the input's change from the previous knot to each knot [1/pu]; at
/// the first knot, of the input itself.
Eigen::VectorXd walk_weights(const Knots& knots, event::InputKind kind);

/// Returns the prior standard deviation of each variable of an event's state, in the units of the search
/// (fit/states.hpp). For a switching time it is the uncertainty of that time.
std::vector<double> own_priors(const event::FitEvent& event);
/// Clamps the switching times of an event's state to within their uncertainties.
void keep_in_range(const event::FitEvent& event, Eigen::VectorXd& state);

inline constexpr int kInferenceSteps = 5;  ///< maximum number of Gauss-Newton steps of an inference
/// Infers the inputs from the submitted values. Throws InputError if the submitted model cannot be simulated.
Inference infer(const sim::plant::PlantUnderTest& tested, const noise::WhitenedEvents& events,
                const std::vector<fit::FreeParameter>& free, Inputs inputs, int threads,
                int steps = kInferenceSteps);

/// Two inferences: at the prior intensity of the inputs' random walk (variance as in walk_weights()), and at
/// the most probable intensity. The second starts from the first. Its intensity is small if the records
/// require no input.
struct SmoothInference {
  Inference prior, smooth;  ///< at the prior intensity, and at the most probable one
};
/// Computes both inferences. `from`: a fit of the tested plant without inputs, near which the residuals are
/// almost linear in the inputs. The first inference is then the linearisation at this fit. If `from` is null,
/// the first inference starts at the submitted values. Throws InputError in the same cases as infer().
SmoothInference infer_smooth(const sim::plant::PlantUnderTest& tested, const noise::WhitenedEvents& events,
                             const std::vector<fit::FreeParameter>& free, Inputs inputs, int threads,
                             const fit::Fit* from);
/// Linearises about `plant` without any step, at the given event states. The requested inputs, which
/// are added to Tm and Efd, are zero unless `states` contains them; their Jacobians are computed. `plant` is
/// the tested plant, or has a block added or replaced. Throws InputError if it cannot be simulated.
Inference linear_about(const sim::plant::Plant& plant, const sim::plant::PlantUnderTest& tested,
                       const noise::WhitenedEvents& events, const std::vector<fit::FreeParameter>& free,
                       const std::vector<event::EventState>& states, Inputs inputs, int threads);

}  // namespace swingbank::validate::reduced
