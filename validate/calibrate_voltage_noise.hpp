#pragma once
// Noise of the measured voltage goes through the plant into the answer it is compared by, and into the slopes
// along the parameters: a fit is then pulled to where the plant passes least of it (reactances too large),
// and counts slopes that are noise as information. Whitening leaves that; what both amount to is computed and
// taken back.
#include "validate/calibrate_slopes.hpp"

namespace swingbank::validate {

struct VoltagePull {
  Eigen::VectorXd score;        ///< J'r expected at the truth, summed over the events' samples
  Eigen::MatrixXd information;  ///< J'J that noise pretends
};

/// White noise of these variances [V/V, rad], played into the plant for a minute at the operating point of
/// the first event; the residual is whitened as the event's is.
VoltagePull voltage_pull(const sim::Plant& plant, const sim::Conventions& conventions,
                         const std::vector<FitEvent>& events, const Eigen::Vector2d& variance,
                         const std::vector<FreeParameter>& free);

}  // namespace swingbank::validate
