#pragma once
// Normal equations of an inference about one point, and their results: Gauss-Newton steps, log determinant of
// the posterior precision, standard deviations of the inputs.
#include "validate/fit/axis.hpp"
#include "validate/reduced/infer.hpp"

namespace swingbank::validate::reduced::detail {

/// Values of all free variables: plant parameters in the search's coordinate z (fit/axis.hpp); state, in the
/// units of the search (fit/states.hpp), and inputs [pu] of each event.
struct Point {
  Eigen::VectorXd z;
  std::vector<Eigen::VectorXd> states, torques, fields;
};

/// Half the Hessian and half the gradient of the cost. `plant`: block of the plant's parameters; `own`: block
/// of each event's state, torque and field voltage; `cross`: block that couples `plant` and `own`.
struct Normal {
  Eigen::MatrixXd plant;
  Eigen::VectorXd gradient;
  std::vector<Eigen::MatrixXd> own, cross;
  std::vector<Eigen::VectorXd> own_gradient;
  /// Diagonals of `own` without the inputs' prior. For a small intensity this prior is very stiff. Damping in
  /// proportion to the stiff prior would keep all knots at their values.
  std::vector<Eigen::VectorXd> own_scale;
};

/// Returns the normal equations of the residuals and of the priors of parameters and states, without the
/// inputs' prior.
Normal without_walks(const std::vector<EventSensitivities>& sensitivities, const std::vector<fit::Axis>& axes,
                     const Point& at, const noise::WhitenedEvents& events);
/// Adds the prior of the inputs: a random walk of `intensity` times the variance in walk_weights().
void add_walks(const std::vector<EventSensitivities>& sensitivities, const Point& at, double intensity,
               Normal& normal);
/// Returns the cost of the inputs' prior.
double walk_cost(const std::vector<Knots>& knots, const Point& at, double intensity);

/// The step to the minimum of the quadratic model.
struct Step {
  Eigen::VectorXd z;
  std::vector<Eigen::VectorXd> own;
  double falls = 0;            ///< reduction of the quadratic model's cost
  double log_determinant = 0;  ///< log determinant of half the Hessian
};
/// Computes the step. `damping` times the scale of the diagonals is added to the diagonals.
Step step_of(const Normal& normal, double damping = 0);

/// Returns the posterior standard deviations of each event's own variables.
std::vector<Eigen::VectorXd> deviations(const Normal& normal);

}  // namespace swingbank::validate::reduced::detail
