#include "validate/reduced/closed_loop.hpp"

#include <limits>

#include "validate/reduced/detail/with_state.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::reduced {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

}  // namespace

ClosedLoop::ClosedLoop(Inference inference, const noise::WhitenedEvents& events)
    : inference_(std::move(inference)), events_(events) {
  for (std::size_t e = 0; e < events.size(); ++e) {
    const EventSensitivities& s = inference_.events[e];
    const Index states = s.state.cols();
    MatrixXd columns(s.residual.size(), s.plant.cols() + 1);
    columns << s.plant, s.residual;
    const MatrixXd all = detail::with_state(events[e], s, columns);
    Event linear;
    linear.basis = Eigen::HouseholderQR<MatrixXd>(all.leftCols(states)).householderQ() *
                   MatrixXd::Identity(all.rows(), states);
    const MatrixXd rest = all.rightCols(columns.cols()),
                   left = rest - linear.basis * (linear.basis.transpose() * rest);
    linear.plant = left.leftCols(s.plant.cols());
    linear.residual = left.rightCols(1);
    rows_ += all.rows();
    linear_.push_back(std::move(linear));
  }
}

MatrixXd ClosedLoop::responses(const std::vector<sim::plant::Plant>& plants,
                               const sim::Conventions& conventions) const {
  MatrixXd all = MatrixXd::Zero(rows_, static_cast<Index>(plants.size()));
  Index row = 0;
  for (std::size_t e = 0; e < events_.size(); ++e) {
    const VectorXd& residual = inference_.events[e].residual;
    const auto responses =
        event::play_together(plants, conventions, events_[e], inference_.states[e], {.lenient = true});
    noise::RowMatrix changed = noise::RowMatrix::Zero(residual.size(), all.cols());
    for (std::size_t k = 0; k < plants.size(); ++k)
      if (responses[k]) changed.col(static_cast<Index>(k)) = events_[e].collected(responses[k]->value, true);
    events_.noise(e).whiten(changed);
    changed.colwise() -= residual;
    const MatrixXd& basis = linear_[e].basis;
    auto rows = all.middleRows(row, basis.rows());
    rows.topRows(residual.size()) = changed;
    rows -= basis * (basis.topRows(residual.size()).transpose() * changed);
    for (std::size_t k = 0; k < plants.size(); ++k)
      if (!responses[k])
        rows.col(static_cast<Index>(k)).setConstant(std::numeric_limits<double>::quiet_NaN());
    row += basis.rows();
  }
  return all;
}

ClosedLoopCost::ClosedLoopCost(const ClosedLoop& plant, const sim::Conventions& conventions,
                               const std::vector<char>& held)
    : plant_(plant), conventions_(conventions) {
  eliminate(plant.inference(), {}, held);
  for (const ClosedLoop::Event& e : plant.events())
    add({.r = e.residual,
         .by_gain = VectorXd::Zero(e.residual.size()),
         .T = e.plant(Eigen::all, eliminated()),
         .L = {}});
  finish();
}

bool ClosedLoopCost::acts(const VectorXd& response) const {
  return response.squaredNorm() > thresholds::search.other_steps;
}

}  // namespace swingbank::validate::reduced
