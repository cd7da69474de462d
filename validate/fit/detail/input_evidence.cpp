#include "validate/fit/detail/input_evidence.hpp"

#include <algorithm>
#include <cmath>

namespace swingbank::validate::fit::fitting {
namespace {

double log_determinant(const Eigen::LDLT<Eigen::MatrixXd>& m) { return m.vectorD().array().log().sum(); }

/// Products of an input's bends: the first knot and the first slope count as bends from zero, as in Bends.
/// Their determinant is one.
Eigen::MatrixXd bends(Eigen::Index knots) {
  Eigen::MatrixXd b = Eigen::MatrixXd::Identity(knots, knots);
  b.diagonal<-1>().setConstant(-2);
  b.diagonal<-2>().setConstant(1);
  return b.transpose() * b;
}

/// The sizes of bends that are averaged over, in units of the one given.
std::vector<double> sizes() {
  constexpr int kDecades = 3, kEach = 4, kUpwards = 2;
  std::vector<double> all;
  for (int k = -kDecades * kEach; k <= kUpwards; ++k)
    all.push_back(std::pow(10.0, static_cast<double>(k) / kEach));
  return all;
}

}  // namespace

InputEvidence::InputEvidence(const Eigen::VectorXd& precision, const Eigen::VectorXd& z)
    : precision_(precision), z_(z) {}

void InputEvidence::add(const Eigen::MatrixXd& by_z, const Eigen::MatrixXd& by_state,
                        const Eigen::VectorXd& residuals, const Eigen::VectorXd& precision,
                        const Eigen::VectorXd& input) {
  Event e{Eigen::MatrixXd(by_z.rows(), by_z.cols() + by_state.cols()), residuals, precision, input};
  e.slopes << by_z, by_state;
  events_.push_back(std::move(e));
}

double InputEvidence::cost(double bend) const {
  // Order: parameters, states of all events, knots of all events. chi2 of a step d is c + 2 g'd + d'Ad.
  const Eigen::Index parameters = precision_.size();
  Eigen::Index others = parameters, knots = 0;
  for (const Event& e : events_) others += states(e), knots += e.input.size();
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(others + knots, others + knots),
                  bent = Eigen::MatrixXd::Zero(knots, knots);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(others + knots), u(knots);
  double c = z_.dot(precision_.cwiseProduct(z_));
  a.diagonal().head(parameters) = precision_;
  g.head(parameters) = precision_.cwiseProduct(z_);
  Eigen::Index state = parameters, knot = 0;
  for (const Event& e : events_) {
    const Eigen::Index n = e.input.size();
    std::vector<Eigen::Index> at;
    for (Eigen::Index i = 0; i < parameters; ++i) at.push_back(i);
    for (Eigen::Index i = 0; i < states(e); ++i) at.push_back(state + i);
    for (Eigen::Index i = 0; i < n; ++i) at.push_back(others + knot + i);
    a(at, at) += e.slopes.transpose() * e.slopes;
    g(at) += e.slopes.transpose() * e.residuals;
    a.diagonal().segment(state, states(e)) += e.precision;
    bent.block(knot, knot, n, n) = bends(n);
    u.segment(knot, n) = e.input;
    c += e.residuals.squaredNorm();
    state += states(e);
    knot += n;
  }
  // parameters and states follow the input
  const auto known = Eigen::MatrixXd(a.topLeftCorner(others, others)).ldlt();
  const auto known_states =
      Eigen::MatrixXd(a.block(parameters, parameters, others - parameters, others - parameters)).ldlt();
  const Eigen::MatrixXd cross = a.topRightCorner(others, knots);
  const Eigen::MatrixXd h = a.bottomRightCorner(knots, knots) - cross.transpose() * known.solve(cross);
  const Eigen::VectorXd followed = known.solve(g.head(others));
  c -= g.head(others).dot(followed);
  const Eigen::VectorXd pull = h * u - (g.tail(knots) - cross.transpose() * followed);
  // chi2 of an input v is at_zero - 2 pull'v + v'hv
  const double at_zero = c + 2 * pull.dot(u) - u.dot(h * u);
  std::vector<double> costs;
  for (const double size : sizes()) {
    const double prior = 1 / (bend * size * bend * size);
    const Eigen::LDLT<Eigen::MatrixXd> m(h + prior * bent);
    costs.push_back(at_zero - pull.dot(m.solve(pull)) + log_determinant(m) -
                    static_cast<double>(knots) * std::log(prior));
  }
  const double least = *std::ranges::min_element(costs);
  double mean = 0;
  for (const double one : costs) mean += std::exp(0.5 * (least - one)) / static_cast<double>(costs.size());
  return least - 2 * std::log(mean) + log_determinant(known) - log_determinant(known_states);
}

}  // namespace swingbank::validate::fit::fitting
