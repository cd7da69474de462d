#include "validate/fit/rao_score.hpp"

#include <algorithm>
#include <cmath>

#include "validate/fit/detail/event_cost.hpp"
#include "validate/playin/can_run.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::fit {
namespace {

using namespace fitting;

/// Share of a combination of changes, each of length 1, that counts as one of its own.
constexpr double kOwn = 0.02;
/// Share of a change that rounding leaves where the structure could make all of it.
constexpr double kScoreRounding = 1e-7;

/// The residual of one event at the fit, and its slopes.
struct Slopes {
  Eigen::VectorXd residual;
  event::RowMatrix by_parameter, by_state;
};

Slopes slopes_of(const Setting& setting, std::size_t event, const std::vector<double>& z,
                 const std::vector<double>& state) {
  const auto parameters = static_cast<Eigen::Index>(z.size()),
             states = static_cast<Eigen::Index>(state.size());
  const event::RowMatrix e = EventCost(setting, event).slopes(z.data(), state.data());
  if (e.size() == 0)
    throw InputError({"the fitted model cannot be run", (*setting.events)[event].record.name,
                      "it could while it was fitted", "report this"});
  return {e.rightCols(1), e.leftCols(parameters), e.middleCols(parameters, states)};
}

}  // namespace

ScoreTest::ScoreTest(const event::WhitenedEvents& events, const sim::plant::PlantUnderTest& tested,
                     const Fit& fit, bool lenient)
    : events_(events), fit_(fit), lenient_(lenient) {
  require_noise_of(events, fit);
  Setting setting{&tested.plant, &tested.conventions, &events, {}, kFitTolerance};
  setting.lenient = setting.linear_slopes = lenient;
  std::vector<double> at, belief;  // where the fit ended, and what was believed there
  for (const auto& p : fit.parameters) {
    setting.axes.push_back(make_axis(tested.plant, p.where));
    at.push_back(setting.axes.back().z(p.value));
    belief.push_back(p.where.spread > 0 ? 1 / (p.where.spread * p.where.spread) : 0.0);
  }
  const std::vector<double> z = at;
  std::vector<Slopes> each;
  Eigen::Index rows = 0;
  for (std::size_t e = 0; e < events.size(); ++e) {
    const std::vector<double> state = state_of(events[e], fit.events[e].state);
    each.push_back(slopes_of(setting, e, z, state));
    rows += each.back().residual.size();
    at.insert(at.end(), state.begin(), state.end());
    for (const double b : state_beliefs(events[e])) belief.push_back(b > 0 ? 1 / (b * b) : 0.0);
  }
  residual_.resize(rows);
  slopes_ = Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(at.size()));
  Eigen::Index row = 0, column = static_cast<Eigen::Index>(z.size());
  for (const Slopes& s : each) {
    const Eigen::Index n = s.residual.size();
    residual_.segment(row, n) = s.residual;
    slopes_.block(row, 0, n, s.by_parameter.cols()) = s.by_parameter;
    slopes_.block(row, column, n, s.by_state.cols()) = s.by_state;
    row += n;
    column += s.by_state.cols();
  }
  const Eigen::Map<const Eigen::VectorXd> where(at.data(), column), weight(belief.data(), column);
  Eigen::MatrixXd curvature = slopes_.transpose() * slopes_;
  curvature.diagonal() += weight;
  known_.compute(curvature);
  gradient_ = slopes_.transpose() * residual_ + weight.cwiseProduct(where);
}

std::optional<Eigen::MatrixXd> ScoreTest::run(const sim::plant::PlantUnderTest& tested,
                                              const std::vector<playin::Direction>& along) const {
  if (!playin::can_run(tested.plant)) return std::nullopt;
  Eigen::MatrixXd all(residual_.size(), 1 + static_cast<Eigen::Index>(along.size()));
  Eigen::Index row = 0;
  try {
    for (std::size_t e = 0; e < events_.size(); ++e) {
      const event::FitEvent& event = events_[e];
      const playin::Response r =
          event::play(tested, event, fit_.events[e].state, along,
                      {.lenient = lenient_, .linear_slopes = lenient_ && !along.empty()});
      event::RowMatrix some(event.values(), all.cols());
      some.col(0) = event.collected(r.value, true);
      for (std::size_t d = 0; d < along.size(); ++d)
        some.col(1 + static_cast<Eigen::Index>(d)) = event.collected(r.slopes[d].value, false);
      events_.noise(e).whiten(some);
      all.middleRows(row, some.rows()) = some;
      row += some.rows();
    }
  } catch (const InputError&) {
    return std::nullopt;
  }
  if (!all.allFinite()) return std::nullopt;
  return all;
}

ScoreTest::Change ScoreTest::less_shared(Eigen::VectorXd answer) const {
  Change change;
  change.shared = slopes_.transpose() * answer;
  const Eigen::VectorXd taken = known_.solve(change.shared);
  change.whole = answer.squaredNorm();
  change.square = std::max(0.0, change.whole - change.shared.dot(taken));
  if (change.square < kScoreRounding * change.whole) change.square = 0;
  change.along = answer.dot(residual_) - gradient_.dot(taken);
  change.answer = std::move(answer);
  return change;
}

std::optional<ScoreTest::Change> ScoreTest::change_to(const sim::plant::PlantUnderTest& tested) const {
  const auto all = run(tested, {});
  if (!all) return std::nullopt;
  return changed(all->col(0) - residual_);
}

ScoreTest::Change ScoreTest::changed(Eigen::VectorXd answer) const {
  Change change = less_shared(std::move(answer));
  if (change.square < thresholds::search.other_steps) change.square = 0;
  return change;
}

std::vector<std::optional<ScoreTest::Change>> ScoreTest::changes_to(
    std::span<const sim::plant::Plant> plants, const sim::Conventions& conventions) const {
  std::vector<Eigen::VectorXd> answers(plants.size(), -residual_);
  std::vector<char> runs;
  for (const auto& plant : plants) runs.push_back(playin::can_run(plant));
  Eigen::Index row = 0;
  for (std::size_t e = 0; e < events_.size(); ++e) {
    const event::FitEvent& event = events_[e];
    const auto all =
        event::play_together(plants, conventions, event, fit_.events[e].state, {.lenient = lenient_});
    for (std::size_t k = 0; k < plants.size(); ++k) {
      runs[k] = runs[k] && all[k];
      if (!runs[k]) continue;
      event::RowMatrix one = event.collected(all[k]->value, true);
      events_.noise(e).whiten(one);
      answers[k].segment(row, one.rows()) += one;
    }
    row += event.values();
  }
  std::vector<std::optional<Change>> changes(plants.size());
  for (std::size_t k = 0; k < plants.size(); ++k)
    if (runs[k] && answers[k].allFinite()) changes[k] = changed(std::move(answers[k]));
  return changes;
}

bool ScoreTest::apart(const sim::plant::PlantUnderTest& a, const sim::plant::PlantUnderTest& b) const {
  if (!playin::can_run(a.plant) || !playin::can_run(b.plant)) return false;
  double square = 0;
  try {
    for (std::size_t e = 0; e < events_.size() && !(square > thresholds::search.other_steps); ++e) {
      const event::FitEvent& event = events_[e];
      const auto& state = fit_.events[e].state;
      event::RowMatrix moved = event.collected(event::play(b, event, state).value, false) -
                               event.collected(event::play(a, event, state).value, false);
      events_.noise(e).whiten(moved);
      square += moved.squaredNorm();
    }
  } catch (const InputError&) {
    return false;
  }
  return square > thresholds::search.other_steps;
}

std::vector<ScoreTest::Change> ScoreTest::slopes(const sim::plant::PlantUnderTest& tested,
                                                 const std::vector<playin::Direction>& along) const {
  std::vector<Change> changes;
  if (const auto all = run(tested, along))
    for (Eigen::Index d = 1; d < all->cols(); ++d) changes.push_back(less_shared(all->col(d)));
  return changes;
}

double ScoreTest::joint_gain(const std::vector<Change>& changes) const {
  if (changes.empty()) return 0.0;
  const auto n = static_cast<Eigen::Index>(changes.size());
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd along = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Change& a = changes[static_cast<std::size_t>(i)];
    if (!(a.square > 0)) continue;
    along[i] = a.along / std::sqrt(a.square);
    const Eigen::VectorXd taken = known_.solve(a.shared);
    for (Eigen::Index j = 0; j <= i; ++j) {
      const Change& b = changes[static_cast<std::size_t>(j)];
      if (!(b.square > 0)) continue;
      square(i, j) = square(j, i) =
          (a.answer.dot(b.answer) - b.shared.dot(taken)) / std::sqrt(a.square * b.square);
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> of(square);
  double gain = 0;
  for (Eigen::Index i = 0; i < n; ++i)
    if (of.eigenvalues()[i] > kOwn)
      gain += std::pow(of.eigenvectors().col(i).dot(along), 2) / of.eigenvalues()[i] - 1;
  return gain;
}

}  // namespace swingbank::validate::fit
