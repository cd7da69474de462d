#include "validate/reduced/detail/with_state.hpp"

#include <algorithm>

#include "validate/fit/states.hpp"

namespace swingbank::validate::reduced::detail {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

/// Returns the indices of switching times that would leave their range at the optimum of the event's state,
/// with their moves to the end of the range (active set).
std::vector<std::pair<Index, double>> active_bounds(const event::FitEvent& event,
                                                    const EventSensitivities& sensitivities,
                                                    const std::vector<double>& priors) {
  const Index n = sensitivities.state.cols();
  MatrixXd curvature = sensitivities.state.transpose() * sensitivities.state;
  VectorXd gradient = sensitivities.state.transpose() * sensitivities.residual;
  for (Index k = 0; k < n; ++k)
    if (const double b = priors[static_cast<std::size_t>(k)]; b > 0) {
      curvature(k, k) += 1 / (b * b);
      gradient[k] += sensitivities.state_at[k] / (b * b);
    }
  std::vector<std::pair<Index, double>> active;
  for (bool changed = true; changed;) {
    changed = false;
    MatrixXd left = curvature;
    VectorXd right = gradient;
    for (const auto& [k, move] : active) {
      right += curvature.col(k) * move;
      left.row(k).setZero();
      left.col(k).setZero();
      left(k, k) = 1;
    }
    for (const auto& [k, move] : active) right[k] = -move;
    const VectorXd best = sensitivities.state_at - left.ldlt().solve(right);
    VectorXd kept = best;
    keep_in_range(event, kept);
    for (Index k = 0; k < n; ++k)
      if (kept[k] != best[k] && std::ranges::count(active, k, &std::pair<Index, double>::first) == 0) {
        active.emplace_back(k, kept[k] - sensitivities.state_at[k]);
        changed = true;
      }
  }
  return active;
}

}  // namespace

MatrixXd with_state(const event::FitEvent& event, const EventSensitivities& sensitivities,
                    const MatrixXd& columns) {
  const Index states = sensitivities.state.cols(), values = columns.rows();
  MatrixXd all = MatrixXd::Zero(values + states, states + columns.cols());
  all.topRows(values) << sensitivities.state, columns;
  const auto priors = fit::state_priors(event);
  for (Index k = 0; k < states; ++k)
    if (const double b = priors[static_cast<std::size_t>(k)]; b > 0) {
      all(values + k, k) = 1 / b;
      all(values + k, all.cols() - 1) = sensitivities.state_at[k] / b;
    }
  for (const auto& [k, move] : active_bounds(event, sensitivities, priors)) {
    all.rightCols(1) += all.col(k) * move;
    all.col(k).setZero();
    all.row(values + k).setZero();
    all(values + k, k) = 1;
    all(values + k, all.cols() - 1) = -move;
  }
  return all;
}

}  // namespace swingbank::validate::reduced::detail
