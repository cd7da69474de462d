#pragma once
// Bias of a calibration due to noise of the played-in voltage (errors in variables). The noise passes through
// the plant into the response and into the sensitivities. It biases the fit towards parameters with low noise
// transfer (reactances too large), and the noise in the sensitivities counts as information. Whitening
// removes neither effect. This file computes both, and the calibration subtracts them.
#include "validate/fit/sensitivities.hpp"
#include "validate/noise/voltage_noise.hpp"

namespace swingbank::validate::calibrate {

/// Bias of the score J'r and of the information matrix J'J due to noise of the played-in voltage. J:
/// sensitivities; r: residual.
struct VoltagePull {
  Eigen::VectorXd score;        ///< expectation of J'r at the true parameters, summed over all samples
  Eigen::MatrixXd information;  ///< expectation of the part of J'J that noise alone causes
  Eigen::MatrixXd doubt;        ///< covariance of the score due to uncertain noise variances
};

/// Computes the bias from three responses at the operating point of the first event: to an impulse of V, to
/// an impulse of theta, and to a step of an integrated theta. Samples of white noise are independent, so
/// their contributions add up. `whitening`: plant of the innovations filter with which the events' residuals
/// were whitened.
VoltagePull voltage_pull(const sim::plant::PlantUnderTest& tested,
                         const sim::plant::PlantUnderTest& whitening, const noise::WhitenedEvents& events,
                         const noise::VoltageNoise& voltage, const std::vector<fit::FreeParameter>& free);

}  // namespace swingbank::validate::calibrate
