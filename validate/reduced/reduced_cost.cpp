#include "validate/reduced/reduced_cost.hpp"

#include <algorithm>
#include <cmath>

namespace swingbank::validate::reduced {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

/// Prior precision of a change, relative to the squared norm of its column.
constexpr double kChangePrecision = 1e-8;

}  // namespace

std::vector<char> mark_absent(const Inference& inference, const sim::plant::Plant& plant) {
  std::vector<char> marks;
  for (const auto& f : inference.free) marks.push_back(same_parameter(plant, inference.base, f.id) ? 0 : 1);
  return marks;
}

void ReducedCost::eliminate(const Inference& at, Gain gain, const std::vector<char>& held,
                            const std::vector<Index>& freed) {
  const auto is_held = [&](Index i) { return !held.empty() && held[static_cast<std::size_t>(i)]; };
  numbers_ = static_cast<Index>(at.free.size());
  if (gain.number < 0 || !is_held(gain.number)) gain_ = gain;
  std::vector<double> precisions;
  for (Index i = 0; i < numbers_; ++i) {
    const double prior_sd = at.free[static_cast<std::size_t>(i)].prior_sd,
                 precision = prior_sd > 0 ? 1 / (prior_sd * prior_sd) : 0.0;
    if (i == gain_.number) {
      gain_precision_ = precision;
      gain_offset_ = at.offset[i];
      continue;
    }
    prior_cost_ += precision * at.offset[i] * at.offset[i];
    if (is_held(i)) continue;
    free_.push_back(i);
    precisions.push_back(precision);
  }
  const auto parameters = static_cast<Index>(free_.size());
  for (const Index change : freed) free_.push_back(numbers_ + change);
  precision_ = VectorXd::Zero(static_cast<Index>(free_.size()));
  first_ = precision_;
  for (Index k = 0; k < parameters; ++k) {
    precision_[k] = precisions[static_cast<std::size_t>(k)];
    first_[k] = precision_[k] * at.offset[free_[static_cast<std::size_t>(k)]];
  }
}

void ReducedCost::finish() {
  MatrixXd curvature = precision_.asDiagonal();
  for (const Event& e : events_) curvature += e.T.transpose() * e.T;
  // A change has a weak prior, which matters only if columns are collinear.
  for (Index k = 0; k < precision_.size(); ++k)
    if (free_[static_cast<std::size_t>(k)] >= numbers_) curvature(k, k) *= 1 + kChangePrecision;
  inverse_ = curvature.ldlt().solve(MatrixXd::Identity(curvature.rows(), curvature.rows()));
}

double ReducedCost::factor(double gain) const { return std::exp(gain_.exponent * gain); }

Index ReducedCost::rows(const Event& e) { return e.L.size() > 0 ? e.L.cols() : e.r.size(); }

MatrixXd ReducedCost::seen(const Event& e, const MatrixXd& responses) {
  return e.L.size() > 0 ? MatrixXd(e.L * responses) : responses;
}

VectorXd ReducedCost::costs(const MatrixXd& responses, const VectorXd& gains) const {
  const Index count = responses.cols();
  VectorXd cost = VectorXd::Constant(count, prior_cost_);
  cost.array() += gain_precision_ * (gains.array() + gain_offset_).square();
  MatrixXd gradient = first_.replicate(1, count);
  const VectorXd factors = (gain_.exponent * gains).array().exp();
  Index row = 0;
  for (const Event& e : events_) {
    MatrixXd left = seen(e, responses.middleRows(row, rows(e)) * factors.asDiagonal());
    left.colwise() += e.r;
    left += e.by_gain * gains.transpose();
    cost += left.colwise().squaredNorm();
    gradient += e.T.transpose() * left;
    row += rows(e);
  }
  cost -= (gradient.array() * (inverse_ * gradient).array()).colwise().sum().matrix();
  return cost;
}

ReducedCost::Quadratic ReducedCost::quadratic(const VectorXd& response, double gain,
                                              const MatrixXd& jacobian) const {
  const Index n = jacobian.cols() + 1, m = static_cast<Index>(free_.size());
  Quadratic quadratic{MatrixXd::Zero(n, n), VectorXd::Zero(n)};
  MatrixXd cross = MatrixXd::Zero(m, n);
  VectorXd gradient = first_;
  quadratic.curvature(0, 0) = gain_precision_;
  quadratic.gradient[0] = gain_precision_ * (gain_offset_ + gain);
  Index row = 0;
  for (const Event& e : events_) {
    MatrixXd by(e.r.size(), n);
    by.rightCols(n - 1) = factor(gain) * seen(e, jacobian.middleRows(row, rows(e)));
    const VectorXd shown = factor(gain) * seen(e, response.segment(row, rows(e)));
    by.col(0) = e.by_gain + gain_.exponent * shown;
    const VectorXd left = e.r + shown + gain * e.by_gain;
    quadratic.curvature += by.transpose() * by;
    quadratic.gradient += by.transpose() * left;
    cross += e.T.transpose() * by;
    gradient += e.T.transpose() * left;
    row += rows(e);
  }
  quadratic.curvature -= cross.transpose() * inverse_ * cross;
  quadratic.gradient -= cross.transpose() * (inverse_ * gradient);
  return quadratic;
}

VectorXd ReducedCost::plant_of(const VectorXd& response, double gain) const {
  VectorXd gradient = first_;
  Index row = 0;
  for (const Event& e : events_) {
    gradient +=
        e.T.transpose() * (e.r + factor(gain) * seen(e, response.segment(row, rows(e))) + gain * e.by_gain);
    row += rows(e);
  }
  const VectorXd step = -(inverse_ * gradient);
  VectorXd all = VectorXd::Zero(numbers_);
  for (std::size_t k = 0; k < free_.size(); ++k)
    if (free_[k] < numbers_) all[free_[k]] = step[static_cast<Index>(k)];
  if (gain_.number >= 0) all[gain_.number] = gain;
  return all;
}

}  // namespace swingbank::validate::reduced
