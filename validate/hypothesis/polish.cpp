#include "validate/hypothesis/polish.hpp"

#include <algorithm>
#include <cmath>

#include "validate/fit/states.hpp"

namespace swingbank::validate::hypothesis {
namespace {

using Eigen::Index, Eigen::VectorXd;

/// Maximum number of steps of a fit of the whole plant: brief fit (kLeaderSteps) and final fit
/// (kPolishSteps).
constexpr int kLeaderSteps = 8, kPolishSteps = 40;
/// Maximum number of rounds of linearisation and identification per optimum, and of steps of each
/// identification.
constexpr int kLinearRounds = 3, kLinearSteps = 8;
/// Predicted reduction of the cost (chi2 with priors) below which no further linearisation is made.
constexpr double kSettledCost = 1.0;

}  // namespace

const fit::Fit* Identified::best() const {
  const auto least = std::ranges::min_element(fits, fit::better);
  return least == fits.end() || !least->failed.empty() ? nullptr : &*least;
}

Polish::Polish(const BaseModel& base_model) : base_model_(base_model), free_(free_with_own(base_model)) {
  for (const auto& f : free_) axes_.push_back(fit::make_axis(base_model.plant, f));
}

VectorXd Polish::own_of(const Identified& h, const std::vector<double>& values) {
  VectorXd z(static_cast<Index>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i)
    z[static_cast<Index>(i)] = fit::make_axis(h.trial.plant, h.trial.free[i]).z(values[i]);
  return z;
}

/// Returns the optimum that the reduced plant predicts, as a point, with the base model's parameters clamped
/// to their ranges.
Polish::Point Polish::expected(const Identified& h, const reduced::Reduction& reduction,
                               const reduced::Optimum& found) const {
  Point to{reduction.inference().offset + found.plant, own_of(h, found.values),
           reduction.states_at(base_model_.events, h.input(), found.plant, found.series)};
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    double& z = to.plant[static_cast<Index>(i)];
    z = std::clamp(z, std::min(0.0, axes_[i].z(axes_[i].low)), std::max(0.0, axes_[i].z(axes_[i].high)));
  }
  return to;
}

/// Returns the plant at a point. Parameters of a block that the hypothesis removes are skipped.
sim::plant::Plant Polish::whole(const Identified& h, const Point& point) const {
  sim::plant::Plant plant = h.trial.plant;
  for (std::size_t i = 0; i < free_.size(); ++i)
    if (const auto id = same_parameter(plant, base_model_.plant, free_[i].id))
      parameter_value(plant, *id) = axes_[i].value(point.plant[static_cast<Index>(i)]);
  for (std::size_t i = 0; i < h.trial.free.size(); ++i)
    parameter_value(plant, h.trial.free[i].id) =
        fit::make_axis(h.trial.plant, h.trial.free[i]).value(point.own[static_cast<Index>(i)]);
  return plant;
}

std::vector<event::EventState> Polish::states_of(const Point& point) const {
  std::vector<event::EventState> all;
  for (std::size_t e = 0; e < point.states.size(); ++e)
    all.push_back(fit::event_state(base_model_.events[e], point.states[e].data()));
  return all;
}

double Polish::prior_cost(const Identified& h, const Point& point) const {
  double cost = 0;
  const auto add = [&](double z, double prior_sd) {
    cost += prior_sd > 0 ? z * z / (prior_sd * prior_sd) : 0.0;
  };
  for (std::size_t i = 0; i < free_.size(); ++i) add(point.plant[static_cast<Index>(i)], free_[i].prior_sd);
  for (std::size_t i = 0; i < h.trial.free.size(); ++i)
    add(point.own[static_cast<Index>(i)], h.trial.free[i].prior_sd);
  for (std::size_t e = 0; e < point.states.size(); ++e) {
    const auto prior_sds = fit::state_priors(base_model_.events[e]);
    for (std::size_t k = 0; k < prior_sds.size(); ++k)
      add(point.states[e][static_cast<Index>(k)], prior_sds[k]);
  }
  return cost;
}

Polish::Reduced Polish::linear_about(const Identified& h, const Point& point,
                                     std::span<const reduced::Change> changes) const {
  reduced::Inference about =
      reduced::linear_about(whole(h, point), base_model_.under_test(), base_model_.events, free_,
                            states_of(point), only(h.input()), 1);
  if (!changes.empty())
    add_changes(about, base_model_.events, base_model_.conventions, changes, base_model_.threads);
  return std::make_shared<const reduced::Reduction>(std::move(about), base_model_.events,
                                                    base_model_.conventions);
}

Polish::Reduced Polish::linear_about(const Identified& h, std::span<const reduced::Change> changes) const {
  const fit::Fit& at = *h.best();
  Point point{VectorXd::Zero(static_cast<Index>(free_.size())),
              own_of(h, fit::values_of(at.plant, h.trial.free)),
              {}};
  for (std::size_t i = 0; i < free_.size(); ++i)
    if (const auto id = same_parameter(at.plant, base_model_.plant, free_[i].id))
      point.plant[static_cast<Index>(i)] = axes_[i].z(parameter_value(at.plant, *id));
  for (std::size_t e = 0; e < base_model_.events.size(); ++e) {
    const auto state = fit::state_of(base_model_.events[e], at.events[e].state);
    point.states.push_back(Eigen::Map<const VectorXd>(state.data(), static_cast<Index>(state.size())));
  }
  return linear_about(h, point, changes);
}

Polish::Point Polish::reference(const Identified& h, const reduced::Reduction& reduction,
                                const reduced::Optimum& found) {
  Point at{reduction.inference().offset, own_of(h, found.values), {}};
  for (const auto& e : reduction.inference().events) at.states.push_back(e.state_at);
  return at;
}

template <class F>
bool Polish::between(const Point& from, Point& to, F act) {
  constexpr int kWaysBack = 5;
  for (int k = 0; k < kWaysBack; ++k) {
    try {
      if (act(to)) return true;
    } catch (const InputError&) {  // the whole plant cannot be simulated there
    }
    to.plant = 0.5 * (from.plant + to.plant);
    to.own = 0.5 * (from.own + to.own);
    for (std::size_t e = 0; e < to.states.size(); ++e) to.states[e] = 0.5 * (from.states[e] + to.states[e]);
  }
  return false;
}

void Polish::briefly(Identified& h, const reduced::Reduction& from) const {
  const reduced::Optimum& found = h.optima.front();
  const Point at = reference(h, from, found);
  Point to = expected(h, from, found);
  to.states = at.states;
  between(at, to, [&](const Point& point) {
    fit::Fit f =
        fit_from(h, point, {.iterations = kLeaderSteps, .lenient = true, .brief = true, .errors = false});
    if (!f.failed.empty()) return false;
    h.fits = {std::move(f)};
    return true;
  });
}

void Polish::polish(Identified& h, const reduced::Reduction& from, double goal) const {
  std::vector<fit::Fit> polished;
  double given_up = std::numeric_limits<double>::infinity();
  for (const reduced::Optimum& optimum : h.optima) {
    Point at = reference(h, from, optimum), to = expected(h, from, optimum);
    double cost = std::numeric_limits<double>::infinity();
    bool out_of_reach = false;
    for (int round = 0; round < kLinearRounds; ++round) {
      Reduced reduction;
      double there = cost;
      const auto is_lower = [&](const Point& point) {
        reduction = linear_about(h, point);
        there = reduction->inference().chi2 + prior_cost(h, point);
        return there < cost;
      };
      if (!between(at, to, is_lower)) break;
      at = to;
      cost = there;
      const auto nearby =
          reduced::identify(*reduction, h.input(), h.trial, {.draws = 0, .kept = 0, .steps = kLinearSteps},
                            {fit::values_of(whole(h, at), h.trial.free)});
      if (nearby.empty() || cost - nearby.front().cost < kSettledCost) break;
      // The first prediction does not count: its linearisation point may be far from the optimum.
      if (round > 0 && nearby.front().cost > goal) {
        given_up = std::min(given_up, nearby.front().cost);
        out_of_reach = true;
        break;
      }
      to = expected(h, *reduction, nearby.front());
    }
    if (out_of_reach) continue;
    if (fit::Fit f = fit_from(
            h, at,
            {.iterations = kPolishSteps, .lenient = true, .errors = false, .goal = {goal, kPolishSteps}});
        f.failed.empty())
      polished.push_back(std::move(f));
  }
  if (!polished.empty())
    h.fits = std::move(polished);
  else if (h.fits.empty() && std::isfinite(given_up))
    h.cost = given_up;
}

fit::Fit Polish::fit_from(const Identified& h, const Point& point, fit::FitOptions options) const {
  Hypothesis brought = h.hypothesis;
  bring(base_model_, brought);
  const auto free = free_of(brought, base_model_.prior_sd);
  options.start = states_of(point);
  options.values = fit::values_of(whole(h, point), free);
  return fit_at(base_model_, {h.trial.plant, brought.conventions}, free, options);
}

}  // namespace swingbank::validate::hypothesis
