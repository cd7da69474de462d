#pragma once
// Noise of the measured voltage goes through the plant into the answer it is compared by, and into the slopes
// along the parameters: a fit is then pulled to where the plant passes least of it (reactances too large),
// and counts slopes that are noise as information. What both amount to is computed and taken back.
#include "validate/calibrate_slopes.hpp"

namespace swingbank::validate {

/// The first `count` values less their mean and slope.
std::vector<double> detrended(const std::vector<double>& x, int count);

struct VoltageNoise {
  /// Share of the pre-event movement of V that is the instrument's: 1 if the measured P and Q do not answer
  /// it, 0 if they do as the model says, for then the plant has really seen it.
  double share = 0;
  Eigen::VectorXd score;        ///< J'r expected at the truth, summed over the events' samples
  Eigen::MatrixXd information;  ///< J'J that noise pretends
};

/// From the pre-event stretches of the events: their movements of V and theta are drawn again in blocks of
/// half a second over a minute at the operating point, and played into the plant. `slopes`: of the same
/// events.
VoltageNoise voltage_noise(const sim::Plant& plant, const sim::Conventions& conventions,
                           const std::vector<FitEvent>& events, const std::vector<EventSlopes>& slopes,
                           const std::vector<FreeParameter>& free);

}  // namespace swingbank::validate
