#pragma once
// Cost function and solver options of the fit to a record without noise.
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>

#include "sim/core/scalar.hpp"

namespace swingbank::sim::direct {

/// Cost function with derivatives from dual numbers. `Residuals` has a member template of<T>(z, first): the
/// residuals at the unknowns z, with sensitivities to kSensitivities unknowns from `first` on.
template <class Residuals>
class DualCostFunction : public ceres::CostFunction {
 public:
  DualCostFunction(int residuals, int unknowns) {
    set_num_residuals(residuals);
    mutable_parameter_block_sizes()->push_back(unknowns);
  }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const auto& own = static_cast<const Residuals&>(*this);
    const auto values = own.template of<double>(blocks[0], -1);
    std::ranges::copy(values, residuals);
    bool finite = std::ranges::all_of(values, [](double r) { return std::isfinite(r); });
    if (!finite || !jacobians || !jacobians[0]) return finite;
    const int width = parameter_block_sizes()[0];
    for (int first = 0; first < width; first += kSensitivities) {
      const auto r = own.template of<D8>(blocks[0], first);
      for (std::size_t i = 0; i < r.size(); ++i)
        for (int k = first; k < std::min(first + kSensitivities, width); ++k) {
          const double derivative = r[i].d[k - first];
          jacobians[0][static_cast<std::ptrdiff_t>(i) * width + k] = derivative;
          finite = finite && std::isfinite(derivative);
        }
    }
    return finite;
  }

 protected:
  /// Returns unknown number k, z[k] times its scale, with its derivative with respect to z[k].
  template <class T>
  static T unknown(const double* z, std::ptrdiff_t k, double scale, std::ptrdiff_t first) {
    T x(z[k] * scale);
    if constexpr (!std::is_same_v<T, double>)
      if (k >= first && k < first + kSensitivities) x.d.set(static_cast<int>(k - first), scale);
    return x;
  }
};

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
