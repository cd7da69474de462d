#pragma once
// What noise of the measured voltage does to a calibration. It goes through the plant into the answer that
// the record is compared with, and into the slopes along the parameters. A fit is then pulled to where the
// plant passes least of this noise (reactances too large), and counts slopes that are noise as information.
// Whitening does not remove either; both are computed here and taken back.
#include "validate/fit/slopes.hpp"

namespace swingbank::validate::calibrate {

struct VoltagePull {
  Eigen::VectorXd score;        ///< J'r expected at the truth, summed over the events' samples
  Eigen::MatrixXd information;  ///< J'J that noise alone makes, as if it were information
};

/// White noise of these variances [V/V, rad], played into the plant for a minute at the operating point of
/// the first event; the residual is whitened as the event's is.
VoltagePull voltage_pull(const sim::plant::PlantUnderTest& tested, const event::WhitenedEvents& events,
                         const Eigen::Vector2d& variance, const std::vector<fit::FreeParameter>& free);

}  // namespace swingbank::validate::calibrate
