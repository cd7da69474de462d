#pragma once
// Solver options of this module's searches.
#include <ceres/ceres.h>

namespace swingbank::sim::direct {

/// Returns options of a Levenberg-Marquardt search. It stops when the relative change of the cost or of the
/// unknowns is below `settled`.
inline ceres::Solver::Options search_options(int iterations, double settled) {
  ceres::Solver::Options o;
  o.max_num_iterations = iterations;
  o.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  o.logging_type = ceres::SILENT;
  o.num_threads = 1;  // the callers process records in parallel
  o.function_tolerance = o.parameter_tolerance = settled;
  o.gradient_tolerance = 0;
  o.max_num_consecutive_invalid_steps = 12;
  o.max_num_line_search_step_size_iterations = 0;  // no line search if a bound shortens a step
  return o;
}

}  // namespace swingbank::sim::direct
