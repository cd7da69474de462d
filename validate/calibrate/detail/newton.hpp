#pragma once
// Newton steps of a calibration in units of fit::axis_unit().
#include "validate/fit/sensitivities.hpp"

namespace swingbank::validate::calibrate {

/// Returns the deviation of each parameter of `plant` from its prior mean in `believed`, in prior standard
/// deviations.
Eigen::VectorXd off_prior(const sim::plant::Plant& believed, const sim::plant::Plant& plant,
                          const std::vector<fit::FreeParameter>& free);

/// Returns the information of each prior per axis_unit() of `plant`. It is 1 if the fit varies the logarithm
/// of the parameter. Otherwise the prior keeps the standard deviation that it has at the value in `believed`.
Eigen::VectorXd prior_information(const sim::plant::Plant& believed, const sim::plant::Plant& plant,
                                  const std::vector<fit::FreeParameter>& free);

/// Returns the plant after a step in units of axis_unit(), clamped to the parameters' search ranges.
sim::plant::Plant stepped(const sim::plant::Plant& plant, const std::vector<fit::FreeParameter>& free,
                          const Eigen::VectorXd& step);

/// Quasi-Newton correction of Fisher scoring steps, which use the expected instead of the observed curvature.
/// Secant updates use the steps taken so far (Broyden, Math. Comput. 19, 1965, p. 577).
class Secants {
 public:
  explicit Secants(Eigen::Index n) : inverse_(Eigen::MatrixXd::Identity(n, n)) {}
  /// Returns the corrected step for `plain`, the Fisher scoring step.
  Eigen::VectorXd step(const Eigen::VectorXd& plain);
  /// Records the step that was actually taken.
  void taken(const Eigen::VectorXd& step) { taken_ = step; }

 private:
  Eigen::MatrixXd inverse_;
  Eigen::VectorXd plain_, taken_;
};

}  // namespace swingbank::validate::calibrate
