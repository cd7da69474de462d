#include "validate/reduced/reduce.hpp"

#include <algorithm>
#include <cmath>

#include "validate/fit/axis.hpp"
#include "validate/playin/component.hpp"
#include "validate/reduced/detail/with_state.hpp"

namespace swingbank::validate::reduced {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;
using event::InputKind;
using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Returns the triangular factor R with R'R = all'all, from row and column `first` on.
MatrixXd triangle(const MatrixXd& all, Index first) {
  const Eigen::HouseholderQR<MatrixXd> qr(all);
  const Index left = all.cols() - first;
  return qr.matrixQR().block(first, first, left, left).triangularView<Eigen::Upper>();
}

/// Returns weights that average values at the time points over each knot's hat function: [knot][time point].
Sparse over_hats(const Knots& knots, const std::vector<playin::OpenLoop::TimePoint>& times) {
  const auto count = static_cast<Index>(knots.t.size());
  std::vector<Eigen::Triplet<double>> entries;
  VectorXd whole = VectorXd::Zero(count);
  const auto end_of = [&](std::size_t part) {
    return part < knots.discontinuities.size() ? knots.discontinuities[part] : knots.t.size() - 1;
  };
  const auto begin_of = [&](std::size_t part) { return part == 0 ? 0 : end_of(part - 1) + 1; };
  for (std::size_t k = 0; k < times.size(); ++k) {
    const playin::OpenLoop::TimePoint& m = times[k];
    double width = 0;
    if (k > 0 && times[k - 1].segment == m.segment) width += 0.5 * (m.t - times[k - 1].t);
    if (k + 1 < times.size() && times[k + 1].segment == m.segment) width += 0.5 * (times[k + 1].t - m.t);
    const auto part = static_cast<std::size_t>(m.segment - times.front().segment);
    const auto begin = knots.t.begin() + static_cast<std::ptrdiff_t>(begin_of(part)),
               end = knots.t.begin() + static_cast<std::ptrdiff_t>(end_of(part)) + 1;
    if (m.t < *begin) continue;
    const auto above = std::upper_bound(begin + 1, end - 1, m.t);
    const double share = std::clamp((m.t - *(above - 1)) / (*above - *(above - 1)), 0.0, 1.0);
    const Index low = above - 1 - knots.t.begin();
    for (const auto& [knot, height] : {std::pair(low, 1 - share), std::pair(low + 1, share)}) {
      if (height * width == 0) continue;
      entries.emplace_back(knot, static_cast<Index>(k), height * width);
      whole[knot] += height * width;
    }
  }
  for (auto& e : entries) e = {e.row(), e.col(), e.value() / whole[e.row()]};
  Sparse weights(count, static_cast<Index>(times.size()));
  weights.setFromTriplets(entries.begin(), entries.end());
  return weights;
}

/// Returns the ends of the blocks' integration steps: at most four between two knots, none much shorter than
/// a sample.
std::vector<double> steps_between(const Knots& knots, double sample) {
  constexpr double kStepsPerKnot = 4;
  std::vector<double> times{knots.t.front()};
  for (std::size_t k = 1; k < knots.t.size(); ++k) {
    const double gap = knots.t[k] - knots.t[k - 1];
    const int steps = std::max(1, static_cast<int>(std::min(kStepsPerKnot, std::round(gap / sample))));
    for (int i = 1; i <= steps; ++i) times.push_back(knots.t[k - 1] + gap * i / steps);
  }
  return times;
}

VectorXd at_times(const playin::PiecewiseLinear& input,
                  const std::vector<playin::OpenLoop::TimePoint>& times) {
  VectorXd values(static_cast<Index>(times.size()));
  for (std::size_t k = 0; k < times.size(); ++k) {
    // A segment's end is evaluated just before the switching time.
    const bool ends = k + 1 < times.size() && times[k + 1].segment != times[k].segment;
    values[static_cast<Index>(k)] = input(times[k].t - (ends ? sim::plant::kBeforeSwitching : 0.0));
  }
  return values;
}

}  // namespace

Reduction::Reduction(Inference inference, const noise::WhitenedEvents& events,
                     const sim::Conventions& conventions)
    : inference_(std::move(inference)), conventions_(conventions) {
  step_ = events.front().record.step();
  for (std::size_t e = 0; e < events.size(); ++e) {
    const Knots& knots = inference_.events[e].knots;
    const std::vector<double> times = steps_between(knots, step_);
    playin::OpenLoop loop(event::seen_along({inference_.plant, conventions}, events[e], inference_.states[e],
                                            playin::OpenLoop::looks(times)),
                          times, conventions);
    Sparse hats = over_hats(knots, loop.times());
    events_.push_back({std::move(loop), std::move(hats), {}, {}, knots});
    knots_ += static_cast<Index>(knots.t.size());
  }
  const auto beside = [&](InputKind kind) {
    VectorXd series = responses(kind, {inference_.plant}) - responses(kind, {inference_.base});
    Index row = 0;
    for (std::size_t e = 0; e < events_.size(); ++e) {
      const Sparse& hats = events_[e].over_hats;
      const event::EventState& state = inference_.states[e];
      series.segment(row, hats.rows()) +=
          hats * at_times(kind == InputKind::torque ? state.torque : state.field, events_[e].loop.times());
      row += hats.rows();
    }
    return series;
  };
  if (inference_.inputs.torque) torque_ = beside(InputKind::torque);
  if (inference_.inputs.field) field_ = beside(InputKind::field);
  Index row = 0;
  for (std::size_t e = 0; e < events.size(); ++e) {
    const EventSensitivities& s = inference_.events[e];
    const Index states = s.state.cols(), values = s.residual.size(), K = events_[e].over_hats.rows(),
                plant = s.plant.cols() + s.changes.cols();
    VectorXd residual = s.residual;
    if (inference_.inputs.torque) residual -= s.torque * torque_.segment(row, K);
    if (inference_.inputs.field) residual -= s.field * field_.segment(row, K);
    row += K;
    MatrixXd columns(values, plant + s.torque.cols() + s.field.cols() + 1);
    columns.leftCols(s.plant.cols()) = s.plant;
    if (s.changes.cols() > 0) columns.middleCols(s.plant.cols(), s.changes.cols()) = s.changes;
    columns.rightCols(columns.cols() - plant) << s.torque, s.field, residual;
    const MatrixXd all = detail::with_state(events[e], s, columns);
    const Eigen::HouseholderQR<MatrixXd> qr(all);
    const MatrixXd whole = qr.matrixQR().topRows(all.cols()).triangularView<Eigen::Upper>();
    const Index left = all.cols() - states;
    events_[e].triangle = whole.bottomRightCorner(left, left);
    events_[e].by_state = whole.topRows(states);
  }
  torque_gain_ = find_gain(events, InputKind::torque);
  field_gain_ = find_gain(events, InputKind::field);
}

MatrixXd Reduction::responses(InputKind kind, const std::vector<sim::plant::Plant>& plants) const {
  const bool torque = kind == InputKind::torque;
  std::vector<sim::plant::Plant> parts;
  for (const auto& plant : plants)
    parts.push_back(
        playin::component_of(plant, torque ? record::Component::governor : record::Component::exciter));
  MatrixXd all(knots_, static_cast<Index>(parts.size()));
  Index row = 0;
  for (const Event& e : events_) {
    all.middleRows(row, e.over_hats.rows()) =
        e.over_hats * e.loop.run(torque ? playin::Made::torque : playin::Made::field, parts);
    row += e.over_hats.rows();
  }
  return all;
}

std::vector<VectorXd> Reduction::states_at(const noise::WhitenedEvents& events, InputKind kind,
                                           const VectorXd& plant, const VectorXd& series) const {
  const ReducedCost::Gain g = gain(kind);
  const double moved = g.number >= 0 ? g.exponent * plant[g.number] : 0.0;
  std::vector<VectorXd> states;
  Index row = 0;
  for (std::size_t e = 0; e < events_.size(); ++e) {
    const MatrixXd& by = events_[e].by_state;
    const Index n = by.rows(), K = events_[e].over_hats.rows();
    const VectorXd explained =
        std::exp(moved) * series.segment(row, K) - moved * this->series(kind).segment(row, K);
    const VectorXd right = by.rightCols(1) + by.middleCols(n, plant.size()) * plant +
                           by.middleCols(n + plant.size() + changes(), K) * explained;
    const VectorXd move = -by.leftCols(n).triangularView<Eigen::Upper>().solve(right);
    VectorXd to = inference_.events[e].state_at + move;
    keep_in_range(events[e], to);
    states.push_back(std::move(to));
    row += K;
  }
  return states;
}

ReducedCost::Gain Reduction::find_gain(const noise::WhitenedEvents& events, InputKind kind) const {
  constexpr double kGainMove = 1e-4, kNoExponent = 0.1;  // step of a logarithm; smallest exponent of a gain
  const auto rates = [&](const sim::plant::Plant& plant) {
    return event::rates_by_input({plant, conventions_}, events.front(), inference_.states.front(), kind)
        .norm();
  };
  const double still = rates(inference_.base);
  ReducedCost::Gain gain;
  for (std::size_t i = 0; i < inference_.free.size(); ++i) {
    const auto& f = inference_.free[i];
    const fit::Axis axis = fit::make_axis(inference_.base, f);
    if (f.id.block != sim::plant::kMachineBlock || !axis.logarithmic) continue;
    sim::plant::Plant moved = inference_.base;
    parameter_value(moved, f.id) = axis.value(kGainMove);
    const double exponent = std::log(rates(moved) / still) / kGainMove;
    if (std::abs(exponent) > std::max(kNoExponent, std::abs(gain.exponent)))
      gain = {static_cast<Index>(i), exponent};
  }
  return gain;
}

ReducedPlant::ReducedPlant(const Reduction& reduction, InputKind kind, const std::vector<char>& held,
                           const std::vector<Index>& freed)
    : reduction_(reduction), kind_(kind) {
  const Inference& at = reduction.inference();
  const bool field = kind == InputKind::field;
  without_ = reduction.responses(kind, {at.base});
  eliminate(at, reduction.gain(kind), held, freed);
  const Index n = static_cast<Index>(at.free.size()) + reduction.changes();
  Index row = 0;
  for (const Reduction::Event& e : reduction.events()) {
    const MatrixXd& R = e.triangle;
    const auto K = static_cast<Index>(e.knots.t.size());
    MatrixXd plant = R.leftCols(n);
    const bool both = at.inputs.torque && at.inputs.field;
    const MatrixXd explained = R.middleCols(n + (both && field ? K : 0), K),
                   rest = R.middleCols(n + (both && !field ? K : 0), both ? K : 0);
    // Derivative with respect to the gain's parameter at constant product of gain and input.
    if (gain().number >= 0)
      plant.col(gain().number) -= gain().exponent * (explained * reduction.series(kind).segment(row, K));
    const Index first = rest.cols();
    MatrixXd all = MatrixXd::Zero(R.rows() + first, first + n + K + 1);
    all.topRows(R.rows()) << rest, plant, explained, R.rightCols(1);
    if (both) {
      const VectorXd weight = walk_weights(e.knots, field ? InputKind::torque : InputKind::field);
      for (Index k = 0; k < K; ++k) {
        all(R.rows() + k, k) = weight[k];
        if (k > 0) all(R.rows() + k, k - 1) = -weight[k];
      }
    }
    const MatrixXd left = triangle(all, first);
    add({.r = left.rightCols(1),
         .by_gain = gain().number >= 0 ? VectorXd(left.col(gain().number)) : VectorXd::Zero(left.rows()),
         .T = left(Eigen::all, eliminated()),
         .L = left.middleCols(n, K)});
    row += K;
  }
  finish();
}

MatrixXd ReducedPlant::responses(const std::vector<sim::plant::Plant>& plants) const {
  MatrixXd made = reduction_.responses(kind_, plants);
  made.colwise() -= without_;
  return made;
}

}  // namespace swingbank::validate::reduced
