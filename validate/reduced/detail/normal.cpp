#include "validate/reduced/detail/normal.hpp"

#include <cmath>

namespace swingbank::validate::reduced::detail {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;
using event::InputKind;

double log_determinant(const Eigen::LDLT<MatrixXd>& solver) { return solver.vectorD().array().log().sum(); }

double walked(const Knots& knots, InputKind kind, const VectorXd& input) {
  const VectorXd weight = walk_weights(knots, kind);
  double cost = std::pow(weight[0] * input[0], 2);
  for (Index k = 1; k < input.size(); ++k) cost += std::pow(weight[k] * (input[k] - input[k - 1]), 2);
  return cost;
}

void add_walk(const Knots& knots, InputKind kind, const VectorXd& input, Index first, double intensity,
              MatrixXd& curvature, VectorXd& gradient) {
  const VectorXd weight = walk_weights(knots, kind);
  for (Index k = 0; k < input.size(); ++k) {
    const double w = weight[k] * weight[k] / intensity, before = k > 0 ? input[k - 1] : 0.0;
    const Index at = first + k;
    curvature(at, at) += w;
    gradient[at] += w * (input[k] - before);
    if (k == 0) continue;
    curvature(at - 1, at - 1) += w;
    curvature(at, at - 1) -= w;
    curvature(at - 1, at) -= w;
    gradient[at - 1] -= w * (input[k] - before);
  }
}

}  // namespace

Normal without_walks(const std::vector<EventSensitivities>& sensitivities, const std::vector<fit::Axis>& axes,
                     const Point& at, const noise::WhitenedEvents& events) {
  const auto n = static_cast<Index>(axes.size());
  Normal normal{MatrixXd::Zero(n, n), VectorXd::Zero(n), {}, {}, {}, {}};
  for (Index i = 0; i < n; ++i)
    if (const double prior_sd = axes[static_cast<std::size_t>(i)].prior_sd(); prior_sd > 0) {
      normal.plant(i, i) += 1 / (prior_sd * prior_sd);
      normal.gradient[i] += at.z[i] / (prior_sd * prior_sd);
    }
  for (std::size_t e = 0; e < sensitivities.size(); ++e) {
    const EventSensitivities& s = sensitivities[e];
    const Index states = s.state.cols(), own = states + s.torque.cols() + s.field.cols();
    MatrixXd all(s.residual.size(), n + own);
    all << s.plant, s.state, s.torque, s.field;
    MatrixXd products = MatrixXd::Zero(n + own, n + own);
    products.selfadjointView<Eigen::Lower>().rankUpdate(all.transpose());
    products.triangularView<Eigen::StrictlyUpper>() = products.transpose();
    const VectorXd gradient = all.transpose() * s.residual;
    normal.plant += products.topLeftCorner(n, n);
    normal.gradient += gradient.head(n);
    MatrixXd inner = products.bottomRightCorner(own, own);
    VectorXd inner_gradient = gradient.tail(own);
    const auto priors = own_priors(events[e]);
    for (Index k = 0; k < states; ++k)
      if (const double b = priors[static_cast<std::size_t>(k)]; b > 0) {
        inner(k, k) += 1 / (b * b);
        inner_gradient[k] += at.states[e][k] / (b * b);
      }
    normal.own_scale.emplace_back(inner.diagonal());
    normal.own.push_back(std::move(inner));
    normal.cross.push_back(products.bottomLeftCorner(own, n));
    normal.own_gradient.push_back(std::move(inner_gradient));
  }
  return normal;
}

void add_walks(const std::vector<EventSensitivities>& sensitivities, const Point& at, double intensity,
               Normal& normal) {
  for (std::size_t e = 0; e < sensitivities.size(); ++e) {
    const EventSensitivities& s = sensitivities[e];
    const Index states = s.state.cols();
    if (s.torque.cols() > 0)
      add_walk(s.knots, InputKind::torque, at.torques[e], states, intensity, normal.own[e],
               normal.own_gradient[e]);
    if (s.field.cols() > 0)
      add_walk(s.knots, InputKind::field, at.fields[e], states + s.torque.cols(), intensity, normal.own[e],
               normal.own_gradient[e]);
  }
}

double walk_cost(const std::vector<Knots>& knots, const Point& at, double intensity) {
  double cost = 0;
  for (std::size_t e = 0; e < knots.size(); ++e)
    cost +=
        walked(knots[e], InputKind::torque, at.torques[e]) + walked(knots[e], InputKind::field, at.fields[e]);
  return cost / intensity;
}

Step step_of(const Normal& normal, double damping) {
  MatrixXd curvature = normal.plant;
  VectorXd gradient = normal.gradient;
  curvature.diagonal() *= 1 + damping;
  std::vector<Eigen::LDLT<MatrixXd>> solvers;
  Step step;
  for (std::size_t e = 0; e < normal.own.size(); ++e) {
    MatrixXd own = normal.own[e];
    own.diagonal() += damping * normal.own_scale[e];
    solvers.emplace_back(own);
    MatrixXd both(own.rows(), normal.cross[e].cols() + 1);
    both << normal.cross[e], normal.own_gradient[e];
    const MatrixXd solved = solvers[e].solve(both);
    curvature -= normal.cross[e].transpose() * solved.leftCols(curvature.cols());
    gradient -= normal.cross[e].transpose() * solved.rightCols(1);
    step.falls += normal.own_gradient[e].dot(solved.rightCols(1).col(0));
    step.log_determinant += log_determinant(solvers[e]);
  }
  const Eigen::LDLT<MatrixXd> solver(curvature);
  step.z = solver.solve(-gradient);
  step.falls -= gradient.dot(step.z);
  step.log_determinant += log_determinant(solver);
  for (std::size_t e = 0; e < normal.own.size(); ++e)
    step.own.emplace_back(solvers[e].solve(-normal.own_gradient[e] - normal.cross[e] * step.z));
  return step;
}

std::vector<VectorXd> deviations(const Normal& normal) {
  MatrixXd curvature = normal.plant;
  std::vector<MatrixXd> inverses, solved;
  for (std::size_t e = 0; e < normal.own.size(); ++e) {
    inverses.emplace_back(
        normal.own[e].ldlt().solve(MatrixXd::Identity(normal.own[e].rows(), normal.own[e].cols())));
    solved.emplace_back(inverses[e] * normal.cross[e]);
    curvature -= normal.cross[e].transpose() * solved[e];
  }
  const MatrixXd plant = curvature.ldlt().solve(MatrixXd::Identity(curvature.rows(), curvature.cols()));
  std::vector<VectorXd> all;
  for (std::size_t e = 0; e < normal.own.size(); ++e)
    all.emplace_back((inverses[e].diagonal() + (solved[e] * plant).cwiseProduct(solved[e]).rowwise().sum())
                         .cwiseMax(0.0)
                         .cwiseSqrt());
  return all;
}

}  // namespace swingbank::validate::reduced::detail
