#include "validate/hypothesis/search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "base/in_parallel.hpp"
#include "base/stop_signal.hpp"
#include "validate/fit/interrupted.hpp"
#include "validate/hypothesis/identified.hpp"
#include "validate/hypothesis/posterior.hpp"

namespace swingbank::validate::hypothesis {
namespace {

/// Maximum number of steps of the fit from each start, and of the fit that continues from the best one.
constexpr int kFirstSteps = 4, kLastSteps = 40;
/// Number of evaluated draws of an added effect, in addition to its starts.
constexpr std::size_t kFurtherDraws = 80;

/// Values of all free parameters of a hypothesis, and the events' states.
struct Start {
  std::vector<double> values;
  std::vector<fit::EventState> states;  ///< empty: as prepared
};

/// A hypothesis that is fitted with the whole plant.
struct Candidate {
  Hypothesis hypothesis;
  sim::plant::Plant prior = {};  ///< the plant at its prior mean
  std::vector<fit::FreeParameter> free = {};
  std::vector<Start> starts = {};  ///< empty: the hypothesis has no influence
  std::vector<fit::Fit> fits = {};
};

/// Fits of hypotheses that cannot be identified alone. Draws are evaluated in SIMD batches about two points:
/// the submitted values and the base model's fit. The best draw at each point and the default values are
/// fitted for a few steps. The best of these fits is completed, if it may come within reach of the best
/// hypothesis.
class WholeFits {
 public:
  /// `least`: lowest cost of the hypotheses that are fitted already.
  WholeFits(const BaseModel& base_model, const event::Progress& report, double least)
      : base_model_(base_model), report_(report), least_(least) {
    for (const auto& e : base_model.fit.events) fitted_states_.push_back(e.state);
  }

  std::vector<Judgement> run(std::vector<Hypothesis> all) {
    std::vector<Candidate> candidates;
    for (Hypothesis& h : all) candidates.push_back({std::move(h)});
    const event::Phase screening = first() ? event::Phase::screening : event::Phase::second_screening;
    each(candidates, screening, [&](Candidate& c) { find_starts(c); });
    std::erase_if(candidates, [](const Candidate& c) { return c.starts.empty(); });
    double goal = this->goal(candidates);
    each(candidates, screening, [&](Candidate& c) {
      for (const Start& start : c.starts)
        keep(c, attempt(c, start.values, start.states,
                        {.iterations = kFirstSteps,
                         .lenient = true,
                         .brief = true,
                         .errors = false,
                         .goal = {goal, 2 * kFirstSteps}}));
    });
    std::erase_if(candidates, [](const Candidate& c) { return c.fits.empty(); });
    goal = this->goal(candidates);
    each(candidates, first() ? event::Phase::full_fits : event::Phase::second_full_fits, [&](Candidate& c) {
      const fit::Fit& from = *std::ranges::min_element(c.fits, fit::better);
      std::vector<fit::EventState> states;
      for (const auto& e : from.events) states.push_back(e.state);
      keep(c, attempt(c, fit::values_of(from.plant, c.free), states,
                      {.iterations = kLastSteps, .lenient = true, .goal = {goal, kLastSteps}}));
    });
    std::vector<Judgement> tried;
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
  void find_starts(Candidate& c) const {
    Hypothesis& h = c.hypothesis;
    const std::size_t own = h.free.size();
    bring(base_model_, h);
    auto draws = h.starts;
    draws.insert(draws.end(), h.further.begin(), h.further.end());
    if (h.drawn) {
      const auto& t = base_model_.events.front().record.t;
      for (auto& draw : further_draws(h, own, kFurtherDraws, t.back() - t.front())) {
        draw.insert(draw.end(), draws.front().begin() + static_cast<std::ptrdiff_t>(own),
                    draws.front().end());
        draws.push_back(std::move(draw));
      }
    }
    c.prior = prior_mean(base_model_, h);
    c.free = free_of(h, base_model_.prior_sd);
    bool changes = false;
    const auto add_best = [&](const sim::plant::Plant& about, const std::vector<fit::EventState>& states,
                              bool submitted) {
      const double without =
          chi2_of_each(std::array{about}, base_model_.conventions, base_model_.events, states)[0];
      std::vector<sim::plant::Plant> plants;
      for (const auto& draw : draws) {
        sim::plant::Plant plant = started(h, draw);
        for (const fit::FreeParameter& f : c.free)
          if (const auto id = sim::plant::same_parameter(about, plant, f.id))
            if (std::ranges::find(h.free, f.id, &fit::FreeParameter::id) == h.free.end())
              sim::plant::parameter_value(plant, f.id) = sim::plant::parameter_value(about, *id);
        plants.push_back(std::move(plant));
      }
      const auto chi2 = chi2_of_each(plants, h.conventions, base_model_.events, states);
      for (const double left : chi2)
        changes |= std::isfinite(left) && std::abs(left - without) > thresholds::search.other_steps;
      const auto best = static_cast<std::size_t>(std::ranges::min_element(chi2) - chi2.begin());
      const auto add = [&](std::size_t k) {
        if (!std::isfinite(chi2[k])) return;
        c.starts.push_back({fit::values_of(plants[k], c.free), {}});
        if (!submitted) c.starts.back().states = states;
      };
      if (submitted && best != 0) add(0);  // the draw with the lowest chi2 may have almost no effect
      add(best);
    };
    sim::plant::Plant plant = base_model_.plant;
    for (const fit::FreeParameter& f : base_model_.own)
      sim::plant::parameter_value(plant, f.id) = sim::plant::parameter_value(base_model_.fit.plant, f.id);
    add_best(plant, std::vector<fit::EventState>(base_model_.events.size()), true);
    add_best(base_model_.fit.plant, fitted_states_, false);
    if (!changes) c.starts.clear();
  }
  [[nodiscard]] fit::Fit attempt(const Candidate& c, const std::vector<double>& values,
                                 const std::vector<fit::EventState>& states, fit::FitOptions options) const {
    options.values = values;
    options.start = states;
    return fit_at(base_model_, {c.prior, c.hypothesis.conventions}, c.free, options);
  }
  static void keep(Candidate& c, fit::Fit f) {
    if (f.failed.empty()) c.fits.push_back(std::move(f));
  }
  /// Returns the cost that a fit must be able to reach: within reach of the best, and with half of the
  /// required evidence.
  [[nodiscard]] double goal(const std::vector<Candidate>& candidates) const {
    double least = least_;
    for (const Candidate& c : candidates)
      for (const fit::Fit& f : c.fits) least = std::min(least, fit::penalised(f));
    const double needed = first() ? thresholds::evidence.accepted : thresholds::evidence.second;
    return std::min(least + out_of_reach(), fit::penalised(base_model_.fit) - needed / 2);
  }
  template <class F>
  void each(std::vector<Candidate>& candidates, event::Phase phase, F act) const {
    in_parallel(
        candidates.size(),
        [&](std::size_t i) {
          if (!base_model_.stopped()) until_interrupted([&] { act(candidates[i]); });
        },
        [&](int done, std::size_t i) {
          if (!report_) return;
          const std::string& name = candidates[i].hypothesis.name;
          report_(phase, first() ? name : name + " beside " + base_model_.with, done,
                  static_cast<int>(candidates.size()));
        },
        base_model_.threads);
  }
  /// Returns whether the base model is the given model.
  [[nodiscard]] bool first() const { return base_model_.with.empty(); }

  const BaseModel& base_model_;
  const event::Progress& report_;
  std::vector<fit::EventState> fitted_states_;
  double least_;
};

}  // namespace

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

std::vector<double> chi2_of_each(std::span<const sim::plant::Plant> plants,
                                 const sim::Conventions& conventions, const noise::WhitenedEvents& events,
                                 const std::vector<fit::EventState>& states) {
  std::vector<double> chi2(plants.size(), 0.0);
  for (std::size_t e = 0; e < events.size(); ++e) {
    const auto responses = event::play_together(plants, conventions, events[e], states[e], {.lenient = true});
    for (std::size_t k = 0; k < plants.size(); ++k) {
      fit::EventFit f;
      if (responses[k]) noise::compare(events, e, *responses[k], f);
      chi2[k] += responses[k] ? f.chi2 : std::numeric_limits<double>::infinity();
    }
  }
  return chi2;
}

sim::plant::Plant prior_mean(const BaseModel& base_model, const Hypothesis& h) {
  sim::plant::Plant plant = started(h, h.starts.front());
  for (const fit::FreeParameter& f : base_model.own) {
    const auto id = sim::plant::same_parameter(plant, base_model.plant, f.id).value();
    sim::plant::parameter_value(plant, id) = sim::plant::parameter_value(base_model.plant, f.id);
  }
  return plant;
}

std::optional<fit::Fit> with_errors(const BaseModel& base_model, const Hypothesis& h, const fit::Fit& f) {
  const auto free = free_of(h, base_model.prior_sd);
  fit::Fit known = fit::fit(h.under_test(), base_model.events, free,
                            fit::continued({.iterations = 0, .lenient = true}, f, free));
  if (!known.failed.empty()) return std::nullopt;
  return known;
}

void fit_alone(const BaseModel& base_model, Judgement& j) {
  const auto free = free_of(j.hypothesis, base_model.prior_sd);
  fit::FitOptions o{.lenient = true};
  for (const auto& e : base_model.fit.events) o.start.push_back(e.state);
  j.fit = fit_at(base_model, j.hypothesis.under_test(), free, o);
  j.fitted = j.fit.failed.empty();
  if (j.fitted) j.gain = fit::gain(base_model.fit, j.fit, fit::criterion);
}

void try_from(const BaseModel& base_model, const fit::Fit& other, Judgement& j) {
  const Hypothesis& h = j.hypothesis;
  const auto free = free_of(h, base_model.prior_sd);
  fit::FitOptions o{.lenient = true};
  for (const fit::FreeParameter& f : free) {
    const auto id = sim::plant::same_parameter(other.plant, h.plant, f.id);
    o.values.push_back(id ? sim::plant::parameter_value(other.plant, *id)
                          : sim::plant::parameter_value(j.fit.plant, f.id));
  }
  for (const auto& e : other.events) o.start.push_back(e.state);
  if (fit::Fit f = fit::fit(h.under_test(), base_model.events, free, o);
      f.failed.empty() && fit::better(f, j.fit))
    j.fit = std::move(f);
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
