#pragma once
// How this room's searches run.
#include <ceres/ceres.h>

namespace swingbank::sim::direct {

/// Levenberg-Marquardt until the cost and the unknowns settle to `settled` of themselves.
inline ceres::Solver::Options search_options(int iterations, double settled) {
  ceres::Solver::Options o;
  o.max_num_iterations = iterations;
  o.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  o.logging_type = ceres::SILENT;
  o.num_threads = 1;  // records run side by side
  o.function_tolerance = o.parameter_tolerance = settled;
  o.gradient_tolerance = 0;
  o.max_num_consecutive_invalid_steps = 12;
  o.max_num_line_search_step_size_iterations = 0;  // a step that bounds cut short is tried as it is
  return o;
}

}  // namespace swingbank::sim::direct
