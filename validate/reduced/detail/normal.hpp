#pragma once
// Normal equations of an inference about one point, and what follows from them: Gauss-Newton steps, the log
// determinant of the posterior precision, standard deviations of the inputs.
#include "validate/fit/axis.hpp"
#include "validate/reduced/infer.hpp"

namespace swingbank::validate::reduced::detail {

/// Values of everything that is free: plant parameters on their axes, and of each event its state and inputs.
struct Point {
  Eigen::VectorXd z;
  std::vector<Eigen::VectorXd> states, torques, fields;
};

/// Half the curvature and half the gradient of the cost: of the plant's numbers, of each event's own (state,
/// torque, field voltage), and between the two.
struct Normal {
  Eigen::MatrixXd plant;
  Eigen::VectorXd gradient;
  std::vector<Eigen::MatrixXd> own, cross;
  std::vector<Eigen::VectorXd> own_gradient;
  /// Diagonals of `own` without the inputs' prior, which is so stiff for a small intensity that a multiple of
  /// it would hold all knots where they are.
  std::vector<Eigen::VectorXd> own_scale;
};

/// Of the residuals and of the priors of parameters and states. The inputs have no prior yet.
Normal without_walks(const std::vector<EventSlopes>& slopes, const std::vector<fit::Axis>& axes,
                     const Point& at, const event::WhitenedEvents& events);
/// Adds the prior of the inputs: a random walk of `intensity` times walk_weights' variance.
void add_walks(const std::vector<EventSlopes>& slopes, const Point& at, double intensity, Normal& normal);
/// Cost of the same prior.
double walk_cost(const std::vector<Knots>& knots, const Point& at, double intensity);

/// The step to the minimum of the quadratic model, with the diagonals raised by `damping` times their scale.
struct Step {
  Eigen::VectorXd z;
  std::vector<Eigen::VectorXd> own;
  double falls = 0;            ///< by how much the quadratic model's cost falls
  double log_determinant = 0;  ///< of the curvature
};
Step step_of(const Normal& normal, double damping = 0);

/// Posterior standard deviations of each event's own numbers.
std::vector<Eigen::VectorXd> deviations(const Normal& normal);

}  // namespace swingbank::validate::reduced::detail
