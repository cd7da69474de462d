#include "validate/reduced/reduce.hpp"

#include <algorithm>
#include <cmath>

#include "validate/fit/axis.hpp"
#include "validate/fit/states.hpp"
#include "validate/playin/component.hpp"

namespace swingbank::validate::reduced {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;
using event::InputKind;
using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Prior precision of a change, relative to the squared norm of its column.
constexpr double kChangePrecision = 1e-8;

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

/// Returns the switching times that would leave their range at the optimum of the event's state (active set),
/// with their moves to the end of the range.
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
    MatrixXd all = MatrixXd::Zero(values + states, states + plant + s.torque.cols() + s.field.cols() + 1);
    all.topRows(values).leftCols(states + s.plant.cols()) << s.state, s.plant;
    if (s.changes.cols() > 0)
      all.topRows(values).middleCols(states + s.plant.cols(), s.changes.cols()) = s.changes;
    all.topRows(values).rightCols(all.cols() - states - plant) << s.torque, s.field, residual;
    const auto priors = fit::state_priors(events[e]);
    for (Index k = 0; k < states; ++k)
      if (const double b = priors[static_cast<std::size_t>(k)]; b > 0) {
        all(values + k, k) = 1 / b;
        all(values + k, all.cols() - 1) = s.state_at[k] / b;
      }
    for (const auto& [k, move] : active_bounds(events[e], s, priors)) {
      all.rightCols(1) += all.col(k) * move;
      all.col(k).setZero();
      all.row(values + k).setZero();
      all(values + k, k) = 1;
      all(values + k, all.cols() - 1) = -move;
    }
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
  const Gain g = gain(kind);
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

Reduction::Gain Reduction::find_gain(const noise::WhitenedEvents& events, InputKind kind) const {
  constexpr double kGainMove = 1e-4, kNoExponent = 0.1;  // of a logarithm, of an exponent
  const auto rates = [&](const sim::plant::Plant& plant) {
    return event::rates_by_input({plant, conventions_}, events.front(), inference_.states.front(), kind)
        .norm();
  };
  const double still = rates(inference_.base);
  Gain gain;
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
    : gain_(reduction.gain(kind)) {
  const Inference& at = reduction.inference();
  numbers_ = static_cast<Index>(at.free.size());
  const Index n = numbers_ + reduction.changes();
  const bool field = kind == InputKind::field;
  const auto is_held = [&](Index i) { return !held.empty() && held[static_cast<std::size_t>(i)]; };
  if (gain_.number >= 0 && is_held(gain_.number)) gain_ = {};
  for (Index i = 0; i < numbers_; ++i) {
    const double prior_sd = at.free[static_cast<std::size_t>(i)].prior_sd,
                 precision = prior_sd > 0 ? 1 / (prior_sd * prior_sd) : 0.0;
    if (i == gain_.number) {
      gain_precision_ = precision;
      gain_offset_ = at.offset[i];
      continue;
    }
    prior_cost_ += precision * at.offset[i] * at.offset[i];
    if (!is_held(i)) free_.push_back(i);
  }
  const auto parameters = static_cast<Index>(free_.size());
  for (const Index change : freed) free_.push_back(numbers_ + change);
  const auto m = static_cast<Index>(free_.size());
  MatrixXd curvature = MatrixXd::Zero(m, m);
  first_ = VectorXd::Zero(m);
  for (Index k = 0; k < m; ++k) {
    if (k >= parameters) {  // a weak prior, which matters only for collinear columns
      double square = 0;
      for (const Reduction::Event& e : reduction.events())
        square += e.triangle.col(free_[static_cast<std::size_t>(k)]).squaredNorm();
      curvature(k, k) = kChangePrecision * square;
      continue;
    }
    const Index i = free_[static_cast<std::size_t>(k)];
    const double prior_sd = at.free[static_cast<std::size_t>(i)].prior_sd;
    curvature(k, k) = prior_sd > 0 ? 1 / (prior_sd * prior_sd) : 0.0;
    first_[k] = curvature(k, k) * at.offset[i];
  }
  Index row = 0;
  for (const Reduction::Event& e : reduction.events()) {
    const MatrixXd& R = e.triangle;
    const auto K = static_cast<Index>(e.knots.t.size());
    MatrixXd plant = R.leftCols(n);
    const bool both = at.inputs.torque && at.inputs.field;
    const MatrixXd explained = R.middleCols(n + (both && field ? K : 0), K),
                   rest = R.middleCols(n + (both && !field ? K : 0), both ? K : 0);
    // Derivative with respect to the gain's parameter at constant product of gain and input.
    if (gain_.number >= 0)
      plant.col(gain_.number) -= gain_.exponent * (explained * reduction.series(kind).segment(row, K));
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
    Event event;
    event.T = left(Eigen::all, free_);
    event.by_gain = gain_.number >= 0 ? VectorXd(left.col(gain_.number)) : VectorXd::Zero(left.rows());
    event.L = left.middleCols(n, K);
    event.r = left.rightCols(1);
    curvature += event.T.transpose() * event.T;
    events_.push_back(std::move(event));
    row += K;
  }
  inverse_ = curvature.ldlt().solve(MatrixXd::Identity(m, m));
}

VectorXd ReducedPlant::costs(const MatrixXd& series, const VectorXd& gains) const {
  const Index count = series.cols();
  VectorXd cost = VectorXd::Constant(count, prior_cost_);
  cost.array() += gain_precision_ * (gains.array() + gain_offset_).square();
  MatrixXd gradient = first_.replicate(1, count);
  const VectorXd factors = (gain_.exponent * gains).array().exp();
  Index row = 0;
  for (const Event& e : events_) {
    const Index K = e.L.cols();
    MatrixXd left = e.L * (series.middleRows(row, K) * factors.asDiagonal());
    left.colwise() += e.r;
    left += e.by_gain * gains.transpose();
    cost += left.colwise().squaredNorm();
    gradient += e.T.transpose() * left;
    row += K;
  }
  cost -= (gradient.array() * (inverse_ * gradient).array()).colwise().sum().matrix();
  return cost;
}

ReducedPlant::Quadratic ReducedPlant::quadratic(const VectorXd& series, double gain,
                                                const MatrixXd& jacobian) const {
  const Index n = jacobian.cols() + 1, m = static_cast<Index>(free_.size());
  Quadratic quadratic{MatrixXd::Zero(n, n), VectorXd::Zero(n)};
  MatrixXd cross = MatrixXd::Zero(m, n);
  VectorXd gradient = first_;
  quadratic.curvature(0, 0) = gain_precision_;
  quadratic.gradient[0] = gain_precision_ * (gain_offset_ + gain);
  Index row = 0;
  for (const Event& e : events_) {
    const Index K = e.L.cols();
    MatrixXd by(e.r.size(), n);
    by.rightCols(n - 1) = factor(gain) * (e.L * jacobian.middleRows(row, K));
    const VectorXd shown = factor(gain) * (e.L * series.segment(row, K));
    by.col(0) = e.by_gain + gain_.exponent * shown;
    const VectorXd left = e.r + shown + gain * e.by_gain;
    quadratic.curvature += by.transpose() * by;
    quadratic.gradient += by.transpose() * left;
    cross += e.T.transpose() * by;
    gradient += e.T.transpose() * left;
    row += K;
  }
  quadratic.curvature -= cross.transpose() * inverse_ * cross;
  quadratic.gradient -= cross.transpose() * (inverse_ * gradient);
  return quadratic;
}

VectorXd ReducedPlant::plant_of(const VectorXd& series, double gain) const {
  VectorXd gradient = first_;
  Index row = 0;
  for (const Event& e : events_) {
    const Index K = e.L.cols();
    gradient += e.T.transpose() * (e.r + factor(gain) * (e.L * series.segment(row, K)) + gain * e.by_gain);
    row += K;
  }
  const VectorXd step = -(inverse_ * gradient);
  VectorXd all = VectorXd::Zero(numbers_);
  for (std::size_t k = 0; k < free_.size(); ++k)
    if (free_[k] < numbers_) all[free_[k]] = step[static_cast<Index>(k)];
  if (gain_.number >= 0) all[gain_.number] = gain;
  return all;
}

}  // namespace swingbank::validate::reduced
