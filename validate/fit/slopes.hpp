#pragma once
// What the records say of the parameters at a fitted point: slopes of the whitened answer, without what each
// event's own state absorbs, and the information matrix made of them.
#include <Eigen/Dense>

#include "validate/fit/fit.hpp"

namespace swingbank::validate::fit {

/// One unit of a parameter's axis in `information` is the change that its spread believes in. It is relative
/// where the parameter is above zero (the fit moves its logarithm), and of the size of the value or the
/// bounds otherwise.
double axis_unit(const sim::plant::Plant& plant, const FreeParameter& parameter);

/// One event at a point of the fit.
struct EventSlopes {
  Eigen::MatrixXd slopes;    ///< [sample * channels + channel][parameter], whitened, per axis_unit
  Eigen::VectorXd residual;  ///< likewise, model - measured
  /// Half the slope of the event's least cost along the parameters, its state following with its beliefs.
  Eigen::VectorXd score;
  int channels = 0;
};

/// The event's own state (instants, operating point, start) is projected out of both. Throws InputError where
/// the plant cannot be driven.
EventSlopes event_slopes(const sim::plant::PlantUnderTest& tested, event::WhitenedEvent event,
                         const EventState& state, const std::vector<FreeParameter>& free);

/// J'J of one event: information on the parameters, in units of what their spreads believe.
Eigen::MatrixXd information(const EventSlopes& e);

/// Covariance of the scores J'r, with samples up to `lags` apart taken together (Newey and West, Econometrica
/// 55, 1987). It holds where the residual is coloured or larger than believed. `mean`: expected of each
/// sample.
Eigen::MatrixXd score_covariance(const EventSlopes& e, int lags, const Eigen::VectorXd& mean);

}  // namespace swingbank::validate::fit
