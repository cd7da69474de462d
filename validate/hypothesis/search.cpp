#include "validate/hypothesis/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/in_parallel.hpp"
#include "base/stop_signal.hpp"
#include "validate/fit/interrupted.hpp"
#include "validate/hypothesis/identified.hpp"
#include "validate/hypothesis/posterior.hpp"
#include "validate/reduced/closed_loop.hpp"

namespace swingbank::validate::hypothesis {
namespace {

/// Maximum number of steps. kFirstSteps: of an identification, and of the fit from its optimum. kLastSteps:
/// of the fit that continues the best of these fits.
constexpr int kFirstSteps = 4, kLastSteps = 40;
/// Effort of an identification in closed loop. A trial in closed loop costs far more than one in open loop.
constexpr reduced::IdentifyOptions kClosedLoop{.draws = 4, .kept = 1, .steps = kFirstSteps};

/// Values of all free parameters of a hypothesis, and the events' states.
struct Start {
  std::vector<double> values;
  const std::vector<fit::EventState>* states;
};

/// A hypothesis that is fitted with the whole plant.
struct Candidate {
  Hypothesis hypothesis;
  sim::plant::Plant prior = {};  ///< the plant at its prior mean
  std::vector<fit::FreeParameter> free = {};
  std::vector<Start> starts = {};                         ///< empty: the hypothesis has no influence
  double cost = std::numeric_limits<double>::infinity();  ///< lowest cost of the identification
  std::vector<fit::Fit> fits = {};
};

/// Fits of hypotheses that cannot be identified in open loop. Each is identified in closed loop. The plant's
/// other parameters enter linearly, about the base model's fit and, unless its reduced chi-square is below 4,
/// also about the submitted values. The optima are fitted for a few steps if they promise half of the
/// required evidence. The best of these fits is completed if it may come within reach of the best hypothesis.
class WholeFits {
 public:
  /// `least`: lowest cost of the hypotheses that are fitted already.
  WholeFits(const BaseModel& base_model, const event::Progress& report, double least)
      : base_model_(base_model), report_(report), least_(least) {
    if (base_model.fit.reduced_chi2() >= thresholds::noise.measurable) {
      sim::plant::Plant plant = base_model.plant;
      for (const fit::FreeParameter& f : base_model.own)
        sim::plant::parameter_value(plant, f.id) = sim::plant::parameter_value(base_model.fit.plant, f.id);
      try {
        linearise(plant, std::vector<fit::EventState>(base_model.events.size()));
      } catch (const InputError&) {  // the submitted values cannot be simulated
      }
    }
    linearise(base_model.fit.plant, states_of(base_model.fit.events));
  }

  std::vector<Judgement> run(std::vector<Hypothesis> all) {
    std::vector<Candidate> candidates;
    for (Hypothesis& h : all) candidates.push_back({std::move(h)});
    const event::Phase screening = first() ? event::Phase::screening : event::Phase::second_screening;
    each(candidates, screening, [&](Candidate& c) { find_starts(c); });
    std::erase_if(candidates, [](const Candidate& c) { return c.starts.empty(); });
    std::vector<Judgement> tried;
    const double needed = this->needed();
    std::erase_if(candidates, [&](Candidate& c) {
      if (c.cost < needed && !cannot_be_accepted(base_model_, c.cost, fit::penalised(base_model_.fit)))
        return false;
      tried.push_back(not_fitted(c));
      return true;
    });
    double goal = this->goal(candidates);
    each(candidates, screening, [&](Candidate& c) {
      for (const Start& start : c.starts)
        attempt(c, {.iterations = kFirstSteps,
                    .lenient = true,
                    .brief = true,
                    .start = *start.states,
                    .values = start.values,
                    .errors = false,
                    .goal = {goal, 2 * kFirstSteps}});
    });
    std::erase_if(candidates, [](const Candidate& c) { return c.fits.empty(); });
    goal = this->goal(candidates);
    each(candidates, first() ? event::Phase::full_fits : event::Phase::second_full_fits, [&](Candidate& c) {
      const fit::Fit& from = *std::ranges::min_element(c.fits, fit::better);
      attempt(c, fit::continued({.iterations = kLastSteps, .lenient = true, .goal = {goal, kLastSteps}}, from,
                                c.free));
    });
    for (Candidate& c : candidates) {
      Judgement j;
      j.hypothesis = std::move(c.hypothesis);
      j.fit = std::move(c.fits.back());
      j.gain = fit::gain(base_model_.fit, j.fit,
                         std::isfinite(fit::criterion(j.fit)) ? fit::criterion : fit::penalised);
      tried.push_back(std::move(j));
    }
    return tried;
  }

 private:
  /// Linearises a plant of the base model's structure. Throws InputError if it cannot be simulated.
  void linearise(const sim::plant::Plant& plant, const std::vector<fit::EventState>& states) {
    points_.push_back(std::make_unique<const reduced::ClosedLoop>(
        reduced::linear_about(plant, base_model_.under_test(), base_model_.events, free_with_own(base_model_),
                              states, {}, base_model_.threads),
        base_model_.events));
  }
  void find_starts(Candidate& c) const {
    Hypothesis& h = c.hypothesis;
    reduced::Trial trial = trial_of(base_model_, h);
    std::ranges::copy(h.further, std::back_inserter(trial.starts));
    bring(base_model_, h);
    c.prior = prior_mean(base_model_, h);
    c.free = free_of(h, base_model_.prior_sd);
    for (const auto& point : points_) {
      const reduced::Inference& at = point->inference();
      const reduced::ClosedLoopCost cost(*point, h.conventions, reduced::mark_absent(at, trial.plant));
      for (const reduced::Optimum& optimum : reduced::identify(cost, trial, kClosedLoop)) {
        sim::plant::Plant plant = c.prior;
        for (const fit::FreeParameter& f : c.free)
          if (const auto id = sim::plant::same_parameter(at.base, plant, f.id))
            sim::plant::parameter_value(plant, f.id) = sim::plant::parameter_value(at.base, *id);
        for (std::size_t i = 0; i < trial.free.size(); ++i)
          sim::plant::parameter_value(plant, trial.free[i].id) = optimum.values[i];
        c.starts.push_back({fit::values_of(plant, c.free), &at.states});
        c.cost = std::min(c.cost, optimum.cost);
      }
    }
  }
  /// Returns the judgement of a candidate whose predicted reduction of chi2 is too small.
  [[nodiscard]] Judgement not_fitted(Candidate& c) const {
    Judgement j;
    j.hypothesis = std::move(c.hypothesis);
    j.fit = base_model_.fit;
    j.fitted = false;
    j.gain = fit::penalised(base_model_.fit) - c.cost;
    j.why_not = too_small(j.gain);
    return j;
  }
  void attempt(Candidate& c, const fit::FitOptions& options) const {
    fit::Fit f = fit_at(base_model_, {c.prior, c.hypothesis.conventions}, c.free, options);
    if (f.failed.empty()) c.fits.push_back(std::move(f));
  }
  /// Returns the cost that a fit must be able to reach: near that of the best fit, and low enough for half of
  /// the required evidence.
  [[nodiscard]] double goal(const std::vector<Candidate>& candidates) const {
    double least = least_;
    for (const Candidate& c : candidates)
      for (const fit::Fit& f : c.fits) least = std::min(least, fit::penalised(f));
    return std::min({least + out_of_reach(), needed(), base_model_.required});
  }
  /// Returns the cost at which a hypothesis has half of the required evidence.
  [[nodiscard]] double needed() const {
    const double evidence = first() ? thresholds::evidence.accepted : thresholds::evidence.second;
    return fit::penalised(base_model_.fit) - evidence / 2;
  }
  template <class F>
  void each(std::vector<Candidate>& candidates, event::Phase phase, F act) const {
    for_each_hypothesis(
        base_model_, report_, phase, candidates.size(),
        [&](std::size_t k) { return candidates[k].hypothesis.name; },
        [&](std::size_t k) { act(candidates[k]); });
  }
  /// Returns whether the base model is the given model.
  [[nodiscard]] bool first() const { return base_model_.with.empty(); }

  const BaseModel& base_model_;
  const event::Progress& report_;
  std::vector<std::unique_ptr<const reduced::ClosedLoop>> points_;  ///< linearisations of the base model
  double least_;
};

}  // namespace

void for_each_hypothesis(const BaseModel& base_model, const event::Progress& report, event::Phase phase,
                         std::size_t n, const std::function<std::string(std::size_t)>& name,
                         const std::function<void(std::size_t)>& act) {
  in_parallel(
      n,
      [&](std::size_t k) {
        if (!base_model.stopped()) until_interrupted([&] { act(k); });
      },
      [&](int done, std::size_t k) {
        if (!report) return;
        report(phase, base_model.with.empty() ? name(k) : name(k) + " with " + base_model.with, done,
               static_cast<int>(n));
      },
      base_model.threads);
}

fit::Fit fit_at(const BaseModel& base_model, const sim::plant::PlantUnderTest& tested,
                const std::vector<fit::FreeParameter>& free, const fit::FitOptions& options) {
  const auto report = [&](const fit::Fit& f) {
    if (base_model.reached && f.failed.empty()) base_model.reached(f);
  };
  try {
    fit::Fit found = fit::fit(tested, base_model.events, free, options);
    report(found);
    return found;
  } catch (const fit::InterruptedFit& ended) {
    report(ended.reached);
    throw;
  }
}

std::vector<fit::FreeParameter> free_with_own(const BaseModel& base_model) {
  std::vector<fit::FreeParameter> free = fit::free_parameters(base_model.plant, base_model.prior_sd);
  for (const fit::FreeParameter& f : base_model.own) {
    std::erase_if(free, [&](const fit::FreeParameter& known) { return known.id == f.id; });
    free.push_back(f);
  }
  return free;
}

reduced::Trial trial_of(const BaseModel& base_model, const Hypothesis& h) {
  std::uint64_t stream = 14695981039346656037u;  // FNV-1a hash of the name
  for (const char c : full_name(h)) stream = (stream ^ static_cast<unsigned char>(c)) * 1099511628211u;
  const auto& t = base_model.events.front().record.t;
  return {prior_mean(base_model, h), h.free, stream, t.back() - t.front(), h.starts};
}

bool cannot_be_accepted(const BaseModel& base_model, double predicted, double none) {
  return predicted - thresholds::search.near * (none - predicted) > base_model.required;
}

std::string too_small(double gain) {
  return fmt::format("not fitted: predicted reduction of chi-square {:.0f} is too small", gain);
}

sim::plant::Plant prior_mean(const BaseModel& base_model, const Hypothesis& h) {
  sim::plant::Plant plant = started(h, h.starts.front());
  for (const fit::FreeParameter& f : base_model.own) {
    const auto id = sim::plant::same_parameter(plant, base_model.plant, f.id).value();
    sim::plant::parameter_value(plant, id) = sim::plant::parameter_value(base_model.plant, f.id);
  }
  return plant;
}

fit::Fit with_errors(const BaseModel& base_model, const Hypothesis& h, const fit::Fit& f) {
  const auto free = free_of(h, base_model.prior_sd);
  fit::Fit known = fit::fit(h.under_test(), base_model.events, free,
                            fit::continued({.iterations = 0, .lenient = true}, f, free));
  return known.failed.empty() ? known : f;
}

void fit_alone(const BaseModel& base_model, Judgement& j) {
  const auto free = free_of(j.hypothesis, base_model.prior_sd);
  j.fit = fit_at(base_model, j.hypothesis.under_test(), free,
                 fit::continued({.lenient = true}, base_model.fit, {}));
  j.fitted = j.fit.failed.empty();
  if (j.fitted) j.gain = fit::gain(base_model.fit, j.fit, fit::criterion);
}

fit::Fit fit_from(const BaseModel& base_model, const Hypothesis& h, const fit::Fit& other,
                  const sim::plant::Plant& start) {
  const auto free = free_of(h, base_model.prior_sd);
  fit::FitOptions o = fit::continued({.lenient = true}, other, {});
  for (const fit::FreeParameter& f : free) {
    const auto id = sim::plant::same_parameter(other.plant, h.plant, f.id);
    o.values.push_back(id ? sim::plant::parameter_value(other.plant, *id)
                          : sim::plant::parameter_value(start, f.id));
  }
  return fit::fit(h.under_test(), base_model.events, free, o);
}

void try_from(const BaseModel& base_model, const fit::Fit& other, Judgement& j) {
  if (fit::Fit f = fit_from(base_model, j.hypothesis, other, j.fit.plant);
      f.failed.empty() && fit::better(f, j.fit))
    j.fit = std::move(f);
}

std::vector<Hypothesis> BaseModel::hypotheses() const {
  const bool integrated = std::ranges::any_of(
      events, [](const event::FitEvent& e) { return e.record.angle == record::AngleSource::integrated; });
  return all_hypotheses(under_test(), library, {component(), integrated});
}

std::vector<Judgement> try_hypotheses(const BaseModel& base_model, std::vector<Hypothesis> all,
                                      const event::Progress& report) {
  const auto others = std::stable_partition(
      all.begin(), all.end(), [&](const Hypothesis& h) { return can_be_identified(base_model, h); });
  const auto begin = std::make_move_iterator(all.begin()), middle = std::make_move_iterator(others),
             end = std::make_move_iterator(all.end());
  std::vector<Judgement> whole;
  const auto fit_others = [&](double least) {
    whole = WholeFits(base_model, report, least).run({middle, end});
    for (const Judgement& j : whole) least = std::min(least, fit::penalised(j.fit));
    return least;
  };
  std::vector<Judgement> tried = identified(base_model, {begin, middle}, fit_others, report);
  std::ranges::move(whole, std::back_inserter(tried));
  place_unfitted(tried);
  std::ranges::stable_sort(tried, std::greater<>(), &Judgement::gain);
  return tried;
}

}  // namespace swingbank::validate::hypothesis
