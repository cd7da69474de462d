#pragma once
// What noise of the measured voltage does to a calibration. It goes through the plant into the answer that
// the record is compared with, and into the slopes along the parameters. A fit is then pulled to where the
// plant passes least of this noise (reactances too large), and counts slopes that are noise as information.
// Whitening does not remove either; both are computed here and taken back.
#include "validate/fit/noise.hpp"
#include "validate/fit/slopes.hpp"

namespace swingbank::validate::calibrate {

struct VoltagePull {
  Eigen::VectorXd score;        ///< J'r expected at the truth, summed over the events' samples
  Eigen::MatrixXd information;  ///< J'J that noise alone makes, as if it were information
  Eigen::MatrixXd doubt;        ///< covariance of the score for not knowing the noise's variances
};

/// One sample of V, and one of theta, is moved at the operating point of the first event; every sample of
/// white noise does as much as that, independently. The residual is whitened as the events are,
/// which were whitened through the plant `whitening`.
VoltagePull voltage_pull(const sim::plant::PlantUnderTest& tested,
                         const sim::plant::PlantUnderTest& whitening, const event::WhitenedEvents& events,
                         const fit::VoltageNoise& voltage, const std::vector<fit::FreeParameter>& free);

}  // namespace swingbank::validate::calibrate
