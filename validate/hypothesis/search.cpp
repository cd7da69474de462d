#include "validate/hypothesis/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/in_parallel.hpp"
#include "base/stop_signal.hpp"
#include "validate/hypothesis/detail/starts.hpp"
#include "validate/hypothesis/identified.hpp"
#include "validate/hypothesis/posterior.hpp"

namespace swingbank::validate::hypothesis {
namespace {

/// Steps of the fits: from each start, from the best two of them, and from the stage's fit.
constexpr int kFirstSteps = 4, kMoreSteps = 8, kNestedSteps = 12;
/// Steps from each start beside a stage that nearly fits, and from the best of them.
constexpr int kNearSteps = 3, kOnwardSteps = 9;
/// Steps of the fit that starts with the blocks which the stage has bent as the model has them.
constexpr int kUnbentSteps = 8;
/// A fit goes on in so many rounds at most.
constexpr int kRounds = 5;
/// Steps that later stages may give it: the noise measured again, further starts.
constexpr int kLaterSteps = 22;
/// All hypotheses try so many starts.
constexpr std::size_t kFirstStarts = 2;

const fit::FitOptions kBriefly = {.lenient = true, .brief = true, .errors = false};

class Searcher {
 public:
  /// `known`: those that were tried already, the best first.
  Searcher(const Stage& stage, const event::Progress& report, const std::vector<Judgement>& known)
      : stage_(stage), report_(report), starts_(stage) {
    if (known.empty()) return;
    known_ = known.front().gain;
    known_cost_ = fit::penalised(known.front().fit);
  }

  std::vector<Judgement> run(std::vector<Hypothesis> all) {
    const auto candidates = screened(std::move(all));
    std::vector<Judgement> tried(candidates.size());
    if (starts_.near()) {
      std::vector<std::vector<fit::Fit>> begun(candidates.size());
      each(candidates, first_steps_phase(), [&](std::size_t i) {
        if (!stage_.stopped()) near_first(candidates[i], begun[i]);
      });
      auto onward = promising(candidates, begun, thresholds::search.fair);
      // a fit that is worse than nothing has not arrived yet, and another start is left
      for (std::size_t i = 0; i < candidates.size(); ++i)
        if (!candidates[i].unbent.empty() && gain_of(begun[i]) < 0) onward[i] = 1;
      const double reach = in_reach(begun);
      each(candidates, full_fits_phase(), [&](std::size_t i) {
        const Candidate& c = candidates[i];
        tried[i] = c.nested.empty() ? hopeless(c) : begun_only(c, begun[i]);
        if (!c.nested.empty() && !stage_.stopped())
          tried[i] = onward[i] ? near_onward(c, std::move(begun[i]), reach) : judgement(c, begun[i]);
      });
    } else {
      std::vector<std::vector<fit::Fit>> begun(candidates.size());
      const auto start = [&](std::size_t tries, const std::vector<char>& which) {
        const double reach = in_reach(begun);
        each(candidates, first_steps_phase(), [&](std::size_t i) {
          if (which[i] && !stage_.stopped()) first_steps(candidates[i], tries, reach, begun[i]);
        });
      };
      start(1, std::vector<char>(candidates.size(), 1));
      const auto allowed = allowed_by_inputs(candidates, begun);
      start(kFirstStarts, allowed);
      auto fair = promising(candidates, begun, thresholds::search.fair_at_first);
      for (std::size_t i = 0; i < fair.size(); ++i) fair[i] = fair[i] && allowed[i];
      start(kTries, fair);
      const auto onward = promising(candidates, begun, thresholds::search.fair);
      each(candidates, full_fits_phase(), [&](std::size_t i) {
        tried[i] = begun_only(candidates[i], begun[i]);
        if (!stage_.stopped())
          tried[i] = onward[i] ? more_steps(candidates[i], begun[i]) : judgement(candidates[i], begun[i]);
      });
    }
    std::erase_if(tried, [](const Judgement& j) { return j.fit.events.empty(); });
    std::ranges::sort(tried, std::greater<>(), &Judgement::gain);
    return tried;
  }

 private:
  template <class F>
  void each(const std::vector<Candidate>& candidates, event::Phase phase, F act) const {
    in_parallel(
        candidates.size(), [&](std::size_t i) { until_interrupted([&] { act(i); }); },
        [&](int done, std::size_t i) {
          report(phase, candidates[i].hypothesis.name, done, candidates.size());
        },
        stage_.threads);
  }
  /// Every hypothesis that acts here.
  std::vector<Candidate> screened(std::vector<Hypothesis> all) const {
    std::vector<Candidate> candidates(all.size());
    in_parallel(
        all.size(),
        [&](std::size_t i) {
          if (!stage_.stopped()) until_interrupted([&] { candidates[i] = starts_.of(std::move(all[i])); });
        },
        [&](int done) {
          report(first() ? event::Phase::screening : event::Phase::second_screening, "", done, all.size());
        },
        stage_.threads);
    std::erase_if(candidates, [](const Candidate& c) { return c.starts.empty(); });
    return candidates;
  }
  fit::Fit attempt(const Candidate& c, const sim::plant::Plant& start, const fit::FitOptions& o) const {
    return fit::fit({start, c.hypothesis.conventions}, stage_.events, free_of(c.hypothesis, stage_.spread),
                    o);
  }
  /// Fits the first `tries` starts, the standard values and then the draws, leaving out those that `fits`
  /// holds already.
  void first_steps(const Candidate& c, std::size_t tries, double reach, std::vector<fit::Fit>& fits) const {
    fit::FitOptions o = kBriefly;
    o.iterations = kFirstSteps;
    o.goal = {reach, kFirstSteps + kMoreSteps + kLaterSteps};
    for (std::size_t k = fits.size(); k < std::min(c.starts.size(), tries); ++k)
      fits.push_back(attempt(c, c.starts[k], o));
  }
  /// The cost from which a fit is out of reach of the best one so far.
  [[nodiscard]] double in_reach(const std::vector<std::vector<fit::Fit>>& begun) const {
    double least = known_cost_;
    for (const auto& fits : begun)
      for (const fit::Fit& f : fits) least = std::min(least, fit::penalised(f));
    return least + out_of_reach();
  }
  /// What the best of the fits gains over the stage; minus infinity if there is none.
  double gain_of(const std::vector<fit::Fit>& fits) const {
    double gain = -std::numeric_limits<double>::infinity();
    for (const fit::Fit& f : fits) gain = std::max(gain, fit::gain(stage_.fit, f));
    return gain;
  }
  /// Marks the hypotheses whose first steps gain a fair share of what the best one's do, and the rivals of
  /// its slot.
  std::vector<char> promising(const std::vector<Candidate>& candidates,
                              const std::vector<std::vector<fit::Fit>>& begun, double share) const {
    std::vector<double> gains;
    for (const auto& fits : begun) gains.push_back(gain_of(fits));
    const auto best = std::ranges::max_element(gains);
    std::vector<char> onward;
    for (std::size_t i = 0; i < gains.size(); ++i) {
      const auto leader = static_cast<std::size_t>(best - gains.begin());
      onward.push_back(FittedOn{std::max(*best, known_), candidates[leader].hypothesis.slot, share}(
          gains[i], candidates[i].hypothesis.slot));
    }
    return onward;
  }
  /// Marks the hypotheses that could come to a fair share of what the best one gains, as far as an input that
  /// is free in time could.
  std::vector<char> allowed_by_inputs(const std::vector<Candidate>& candidates,
                                      const std::vector<std::vector<fit::Fit>>& begun) const {
    const auto best = std::ranges::max_element(begun, {}, [&](const auto& fits) { return gain_of(fits); });
    std::vector<char> allowed;
    for (const Candidate& c : candidates) {
      const Hypothesis& h = c.hypothesis;
      const double most = h.side == Side::mechanical   ? stage_.by_torque
                          : h.side == Side::excitation ? stage_.by_field
                                                       : std::numeric_limits<double>::infinity();
      const int slot = candidates[static_cast<std::size_t>(best - begun.begin())].hypothesis.slot;
      allowed.push_back(FittedOn{std::max(gain_of(*best), known_), slot}(most, h.slot));
    }
    return allowed;
  }
  /// Goes on from the best draw and from the standard values. These are not left out for being slow, because
  /// draws that hardly act always look better at first. Beliefs are about the start, not about where its
  /// first steps led.
  Judgement more_steps(const Candidate& c, const std::vector<fit::Fit>& begun) const {
    const auto free = free_of(c.hypothesis, stage_.spread);
    fit::FitOptions o = kBriefly;
    o.iterations = kMoreSteps;
    std::vector<fit::Fit> fits;
    std::size_t best = 0;
    for (std::size_t k = 1; k < begun.size(); ++k)
      if (begun[k].failed.empty() && (best == 0 || fit::better(begun[k], begun[best]))) best = k;
    for (const std::size_t k : {std::size_t{0}, best})
      if (begun[k].failed.empty() && (k > 0 || fits.empty()))
        fits.push_back(attempt(c, c.starts[k], fit::continued(o, begun[k], free)));
    std::erase_if(fits, [](const fit::Fit& f) { return !f.failed.empty(); });
    const bool worse = fits.empty() || fit::better(stage_.fit, *std::ranges::min_element(fits, fit::better));
    if (!c.nested.empty() && (worse || stage_.fit.misfit() < thresholds::search.nested)) {
      o.iterations = kNestedSteps;
      o.values = std::ranges::min_element(c.nested)->second;
      o.start.clear();
      for (const auto& e : stage_.fit.events) o.start.push_back(e.state);
      if (fit::Fit f = attempt(c, c.starts.front(), o); f.failed.empty()) fits.push_back(std::move(f));
    }
    return judgement(c, scanned(c, std::move(fits)));
  }
  Judgement hopeless(const Candidate& c) const {
    Judgement j;
    j.hypothesis = c.hypothesis;
    j.fit = stage_.fit;
    j.fitted = false;
    j.gain = c.promise;
    j.why_not = fmt::format("chi2 would fall by some {:.0f}: not worth a fit", c.promise);
    return j;
  }
  /// Fits from the values and states at which a stage that nearly fits has ended.
  fit::Fit from_stage(const Candidate& c, const std::vector<double>& values, int steps) const {
    fit::FitOptions o = kBriefly;
    o.iterations = steps;
    o.values = values;
    for (const auto& e : stage_.fit.events) o.start.push_back(e.state);
    return attempt(c, c.starts.front(), o);
  }
  void near_first(const Candidate& c, std::vector<fit::Fit>& fits) const {
    for (std::size_t k = 0; k < std::min(c.nested.size(), kTries); ++k)
      if (fit::Fit f = from_stage(c, c.nested[k].second, kNearSteps); f.failed.empty())
        fits.push_back(std::move(f));
  }
  Judgement near_onward(const Candidate& c, std::vector<fit::Fit> fits, double reach) const {
    if (fits.empty()) return judgement(c, fits);
    fit::Fit best = in_rounds(c, *std::ranges::min_element(fits, fit::better), reach);
    if (!c.unbent.empty())
      if (fit::Fit f = from_stage(c, c.unbent, kUnbentSteps);
          fit::gain(best, f) > -thresholds::evidence.within_reach)
        fits.push_back(in_rounds(c, std::move(f), reach));
    fits.push_back(std::move(best));
    return judgement(c, scanned(c, std::move(fits)));
  }
  /// The best of the fits, after parameters without a slope have been scanned as well.
  std::vector<fit::Fit> scanned(const Candidate& c, std::vector<fit::Fit> fits) const {
    if (fits.empty()) return fits;
    return {past_blind(stage_, c.hypothesis, c.starts.front(),
                       std::move(*std::ranges::min_element(fits, fit::better)))};
  }
  /// Fits on in rounds, as long as that is worth it.
  fit::Fit in_rounds(const Candidate& c, fit::Fit best, double reach) const {
    fit::FitOptions o = kBriefly;
    o.iterations = kOnwardSteps;
    const auto free = free_of(c.hypothesis, stage_.spread);
    for (int round = 0; round < kRounds; ++round) {
      o.goal = {reach, (kRounds - round) * kOnwardSteps + kLaterSteps};
      const fit::Fit from = std::exchange(best, attempt(c, c.starts.front(), fit::continued(o, best, free)));
      const double left = fit::gain(best, stage_.fit);
      const bool gets_there = left < thresholds::search.coming * fit::gain(from, stage_.fit);
      if (best.converged || fit::gain(from, best) < thresholds::search.worth_a_round ||
          (left > 0 && !gets_there))
        break;
    }
    return best;
  }
  /// The best of the first fits, for a search that is interrupted: its evidence lacks what the errors add.
  Judgement begun_only(const Candidate& c, const std::vector<fit::Fit>& fits) const {
    Judgement j;
    j.hypothesis = c.hypothesis;
    const auto best = std::ranges::min_element(fits, fit::better);
    if (best == fits.end() || !best->failed.empty()) return j;
    j.fit = *best;
    j.gain = fit::gain(stage_.fit, j.fit);
    return j;
  }
  /// Makes a judgement of the best of the fits.
  Judgement judgement(const Candidate& c, std::vector<fit::Fit> fits) const {
    Judgement j;
    j.hypothesis = c.hypothesis;
    std::erase_if(fits, [](const fit::Fit& f) { return !f.failed.empty(); });
    if (fits.empty()) return j;
    j.fit = with_errors(c, std::move(*std::ranges::min_element(fits, fit::better)));
    j.gain = fit::gain(stage_.fit, j.fit, fit::criterion);
    return j;
  }
  /// The same fit with errors, which its evidence needs.
  fit::Fit with_errors(const Candidate& c, fit::Fit f) const {
    const auto free = free_of(c.hypothesis, stage_.spread);
    fit::FitOptions o = fit::continued({.iterations = 0, .lenient = true}, f, free);
    fit::Fit known = attempt(c, c.starts.front(), o);
    if (!known.failed.empty()) return f;
    known.iterations = f.iterations;
    known.converged = f.converged;
    return known;
  }
  /// Whether nothing was added to the model before.
  [[nodiscard]] bool first() const { return stage_.with.empty(); }
  [[nodiscard]] event::Phase first_steps_phase() const {
    return first() ? event::Phase::quick_fits : event::Phase::second_quick_fits;
  }
  [[nodiscard]] event::Phase full_fits_phase() const {
    return first() ? event::Phase::full_fits : event::Phase::second_full_fits;
  }
  void report(event::Phase phase, const std::string& item, int done, std::size_t total) const {
    if (report_)
      report_(phase, first() ? item : item + " beside " + stage_.with, done, static_cast<int>(total));
  }

  const Stage& stage_;
  const event::Progress& report_;
  StartFinder starts_;
  double known_ =
             -std::numeric_limits<double>::infinity(),  ///< gain and cost of the best that was tried already
      known_cost_ = std::numeric_limits<double>::infinity();
};

}  // namespace

std::vector<Judgement> try_hypotheses(const Stage& stage, std::vector<Hypothesis> all,
                                      const event::Progress& report) {
  const auto others = std::stable_partition(all.begin(), all.end(),
                                            [&](const Hypothesis& h) { return can_be_identified(stage, h); });
  const auto begin = std::make_move_iterator(all.begin()), middle = std::make_move_iterator(others),
             end = std::make_move_iterator(all.end());
  std::vector<Judgement> tried = identified(stage, {begin, middle}, report);
  std::ranges::move(Searcher(stage, report, tried).run({middle, end}), std::back_inserter(tried));
  place_unfitted(tried);
  std::ranges::stable_sort(tried, std::greater<>(), &Judgement::gain);
  return tried;
}

}  // namespace swingbank::validate::hypothesis
