#pragma once
// Newton steps of a calibration along its axes (fit::axis_unit).
#include "validate/fit/slopes.hpp"

namespace swingbank::validate::calibrate {

/// How far each parameter of `plant` is from where `believed` has it, in units of its spread.
Eigen::VectorXd off_belief(const sim::plant::Plant& believed, const sim::plant::Plant& plant,
                           const std::vector<fit::FreeParameter>& free);

/// Information of each prior, per axis_unit of `plant`: 1 where the fit moves the logarithm; elsewhere the
/// prior keeps the width that it has about the value of `believed`.
Eigen::VectorXd prior_information(const sim::plant::Plant& believed, const sim::plant::Plant& plant,
                                  const std::vector<fit::FreeParameter>& free);

/// The plant moved by a step in units of its axes. It stays within the parameters' ranges.
sim::plant::Plant stepped(const sim::plant::Plant& plant, const std::vector<fit::FreeParameter>& free,
                          const Eigen::VectorXd& step);

/// Newton steps whose curvature is only the expected one, corrected by what the steps so far have done
/// (Broyden, Math. Comput. 19, 1965, p. 577).
class Secants {
 public:
  explicit Secants(Eigen::Index n) : inverse_(Eigen::MatrixXd::Identity(n, n)) {}
  /// The step to take where the expected curvature asks for `plain`.
  Eigen::VectorXd step(const Eigen::VectorXd& plain);
  /// What was taken of it.
  void taken(const Eigen::VectorXd& step) { taken_ = step; }

 private:
  Eigen::MatrixXd inverse_;
  Eigen::VectorXd plain_, taken_;
};

}  // namespace swingbank::validate::calibrate
