// Cost of one event and its sensitivities as a Ceres cost function.
#include "validate/fit/detail/event_cost.hpp"

#include <algorithm>
#include <cmath>

#include "base/stop_signal.hpp"
#include "validate/playin/can_run.hpp"

namespace swingbank::validate::fit::fitting {
namespace {

/// Largest prediction error of a step by which sensitivities are corrected, relative to the change of the
/// residuals. A larger error is attributed to nonlinearity of the response, not to the sensitivities.
constexpr double kOffAtMost = 0.2;
/// Sensitivities are reused, at most kGoOn times in a row, if their prediction error of the last step is at
/// most this share of the residuals' change.
constexpr double kMaxPredictionError = 0.2;
constexpr int kGoOn = 6;

bool same(const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return a.size() == b.size() && a == b; }

}  // namespace

noise::RowMatrix triangle_of(const noise::RowMatrix& e) {
  constexpr double kNormRounding = 1e-14;  // relative rounding error of a squared norm
  noise::RowMatrix r = e.transpose() * e;
  const Eigen::Index n = r.cols();
  for (Eigen::Index i = 0; i < n; ++i) {
    const double whole = e.col(i).squaredNorm(), left = r(i, i);
    if (left <= kNormRounding * whole) {
      r.row(i).setZero();
    } else {
      r.row(i).tail(n - i) /= std::sqrt(left);
      for (Eigen::Index k = i + 1; k < n; ++k) r.row(k).tail(n - k) -= r(i, k) * r.row(i).tail(n - k);
    }
    r.row(i).head(i).setZero();
  }
  return r;
}

EventCost::EventCost(const Setting& setting, std::size_t event)
    : setting_(setting), event_((*setting.events)[event]), noise_(setting.events->noise(event)) {
  set_num_residuals(static_cast<int>(setting.axes.size() + state_size()) + 1);
  if (!setting.axes.empty())
    mutable_parameter_block_sizes()->push_back(static_cast<std::int32_t>(setting.axes.size()));
  mutable_parameter_block_sizes()->push_back(static_cast<std::int32_t>(state_size()));
}

bool EventCost::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  try {
    return evaluate(blocks, residuals, jacobians);
  } catch (const Interrupted&) {  // must not pass through Ceres; the search throws it again at its end
    last_ = {};
    return false;
  }
}

bool EventCost::evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  const bool has_axes = !setting_.axes.empty();
  const double *z = has_axes ? blocks[0] : nullptr, *state = blocks[has_axes ? 1 : 0];
  const Eigen::Index rows = num_residuals();
  Eigen::VectorXd here(rows - 1);
  for (Eigen::Index i = 0, n = here.size() - static_cast<Eigen::Index>(state_size()); i < here.size(); ++i)
    here[i] = i < n ? z[i] : state[i - n];
  const bool looks = jacobians && points_ > 0, known = same(here, last_.at);
  if (!known) last_ = {here, {}, nullptr};
  if (looks ? !(known && reuse_sensitivities()) : !known) {
    noise::RowMatrix e = values(z, state, looks);
    if (e.size() == 0) {
      last_ = {};
      return false;
    }
    last_.residual = e.rightCols(1);
    if (looks) take(std::move(e));
  }
  Eigen::Map<Eigen::VectorXd> residual(residuals, rows);
  residual.setZero();
  residual[rows - 1] = last_.residual.norm();
  if (!jacobians) return true;
  noise::RowMatrix r = noise::RowMatrix::Zero(rows, rows);
  if (looks) {
    --points_;
    r = triangle_of(looked_.e);
    residual = r.col(rows - 1);
  }
  Eigen::Index column = 0;
  for (const std::int32_t size : parameter_block_sizes()) {
    if (double* block = *jacobians++)
      Eigen::Map<noise::RowMatrix>(block, rows, size) = r.middleCols(column, size);
    column += size;
  }
  return true;
}

Eigen::MatrixXd EventCost::by_column(const Eigen::VectorXd& missed, const Eigen::VectorXd& step) const {
  const Eigen::VectorXd share =
      looked_.e.leftCols(step.size()).colwise().squaredNorm().transpose().cwiseProduct(step);
  const double whole = share.dot(step);
  return whole > 0 ? Eigen::MatrixXd(missed * (share / whole).transpose())
                   : Eigen::MatrixXd::Zero(missed.size(), step.size());
}

bool EventCost::reuse_sensitivities() const {
  if (!setting_.lenient || looked_.at.size() == 0) return false;
  if (renew_) return false;
  if (same(looked_.at, last_.at)) return true;
  const Eigen::Index n = last_.at.size();
  const Eigen::VectorXd step = last_.at - looked_.at, moved = last_.residual - looked_.e.col(n),
                        missed = moved - looked_.e.leftCols(n) * step;
  if (!setting_.goes_on || looked_.gone_on >= kGoOn || !(missed.norm() <= kMaxPredictionError * moved.norm()))
    return false;
  looked_.e.leftCols(n) += by_column(missed, step);
  looked_.e.col(n) = last_.residual;
  looked_.at = last_.at;
  ++looked_.gone_on;
  return true;
}

void EventCost::take(noise::RowMatrix e) const {
  const Eigen::Index n = last_.at.size();
  if (setting_.lenient && looked_.at.size() > 0) {
    if (looked_.off.size() > 0) e.leftCols(n) += looked_.off;
    const Eigen::VectorXd step = last_.at - looked_.at, moved = e.col(n) - looked_.e.col(n),
                          missed = moved - 0.5 * ((e.leftCols(n) + looked_.e.leftCols(n)) * step);
    if (missed.norm() < kOffAtMost * moved.norm()) {
      const Eigen::MatrixXd more = by_column(missed, step);
      e.leftCols(n) += more;
      if (looked_.off.size() > 0)
        looked_.off += more;
      else
        looked_.off = more;
    }
  }
  looked_.e = std::move(e);
  looked_.at = last_.at;
  looked_.gone_on = 0;
  renew_ = false;
}

noise::RowMatrix EventCost::values(const double* z, const double* state, bool with_sensitivities) const {
  const sim::plant::Plant plant = moved(setting_, z);
  if (!(setting_.can_exist ? playin::can_exist_beside(plant, *setting_.plant) : playin::can_run(plant)))
    return {};
  std::vector<playin::SensitivityParameter> along;
  if (with_sensitivities) {
    for (std::size_t i = 0; i < setting_.axes.size(); ++i) {
      const Axis& a = setting_.axes[i];
      along.push_back({.kind = Kind::parameter, .parameter = a.where.id, .scale = a.derivative(z[i])});
    }
    std::ranges::move(state_parameters(event_), std::back_inserter(along));
  }
  try {
    const playin::Response r = event::play({plant, *setting_.conventions}, event_, at(state), along,
                                           {.tolerance = setting_.tolerance,
                                            .lenient = setting_.lenient,
                                            .allowance = &allowance_,
                                            .cache = &last_.cache});
    const auto n = static_cast<Eigen::Index>(along.size());
    noise::RowMatrix e(event_.values(), n + 1);
    for (Eigen::Index d = 0; d < n; ++d)
      e.col(d) = event_.collected(r.sensitivities[static_cast<std::size_t>(d)].value, false);
    e.col(n) = event_.collected(r.value, true);
    noise_.whiten(e);
    return e;
  } catch (const InputError&) {
    return {};
  }
}

EventState EventCost::at(const double* state) const { return event_state(event_, state); }

playin::Response EventCost::response(const sim::plant::Plant& plant, const EventState& state,
                                     bool lenient) const {
  return event::play({plant, *setting_.conventions}, event_, state, {},
                     {.tolerance = setting_.tolerance, .lenient = lenient, .allowance = &allowance_});
}

}  // namespace swingbank::validate::fit::fitting
