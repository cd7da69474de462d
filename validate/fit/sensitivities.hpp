#pragma once
// Sensitivities of the whitened response to the parameters at a fitted point, with each event's own state
// projected out, and the information matrix.
#include <Eigen/Dense>

#include "validate/fit/fit.hpp"

namespace swingbank::validate::fit {

/// Returns the unit of a parameter in sensitivities and in information() [unit of the parameter]: one prior
/// standard deviation. For a parameter without a prior, the unit is the magnitude of the value. If the value
/// is 0, it is 5 % of the parameter's range, at most 1.
double axis_unit(const sim::plant::Plant& plant, const FreeParameter& parameter);

/// Response of one event with its sensitivities at a point of the fit. They are per axis_unit() of a
/// parameter, and per prior standard deviation of a variable of the event's own state.
struct LinearisedEvent {
  playin::Response response;               ///< response with sensitivities to parameters, then states
  Eigen::MatrixXd by_parameter, by_state;  ///< whitened: [compared value][parameter], [compared value][state]
  Eigen::MatrixXd state_covariance;        ///< covariance of the states at given parameters
  Eigen::MatrixXd absorbed;  ///< [state][parameter]: part of a parameter's effect that the states absorb
  /// Returns the whitened sensitivities to the parameters with the states projected out.
  [[nodiscard]] Eigen::MatrixXd projected() const { return by_parameter - by_state * absorbed; }
};
/// Linearises the response of one event. Throws InputError if the playback fails.
LinearisedEvent linearise(const sim::plant::PlantUnderTest& tested, const noise::WhitenedEvent& event,
                          const EventState& state, const std::vector<FreeParameter>& free,
                          const event::Playing& how = {});
/// Returns the standard deviation of the modelled response of one event: [channel][sample], in pu. It
/// combines the uncertainty of the parameters with that of the event's own state. `covariance`: of the
/// parameters, in units of axis_unit().
std::vector<std::vector<double>> response_deviation(const LinearisedEvent& at, const event::FitEvent& event,
                                                    const Eigen::MatrixXd& covariance);

/// Sensitivities of one event at a point of the fit.
struct EventSensitivities {
  Eigen::MatrixXd sensitivities;  ///< [sample * channels + channel][parameter], whitened, per axis_unit
  Eigen::VectorXd residual;       ///< [sample * channels + channel], model - measured, whitened
  /// Half the gradient of the event's cost with respect to the parameters. The cost includes the priors of
  /// the event's state and is minimised over this state.
  Eigen::VectorXd score;
  int channels = 0;  ///< number of compared channels
};

/// Computes the sensitivities of one event. The event's own state (switching times, operating point, initial
/// motion) is projected out of `sensitivities` and `score`. Throws InputError if the playback fails.
EventSensitivities event_sensitivities(const sim::plant::PlantUnderTest& tested, noise::WhitenedEvent event,
                                       const EventState& state, const std::vector<FreeParameter>& free);

/// Returns J'J of one event, the Fisher information on the parameters in units of axis_unit(). J:
/// sensitivities.
Eigen::MatrixXd information(const EventSensitivities& e);

/// Returns the covariance of the scores J'r with autocovariances up to `lags` samples (Newey and West,
/// Econometrica 55, 1987). It is valid for coloured noise of any level. `mean`: expected score of each
/// sample.
Eigen::MatrixXd score_covariance(const EventSensitivities& e, int lags, const Eigen::VectorXd& mean);

}  // namespace swingbank::validate::fit
