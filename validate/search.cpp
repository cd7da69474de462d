#include "validate/search.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <ranges>

#include "validate/instruments.hpp"
#include "validate/score_test.hpp"

namespace swingbank::validate {
namespace {

/// Starts that are tried, and that the score test looks at; steps of the fits: from each, from the best two
/// of them, and from the stage's fit.
constexpr std::size_t kTries = 4, kScored = 6, kScreened = 10;
constexpr int kFirstSteps = 4, kMoreSteps = 8, kNestedSteps = 12;
/// Steps from each start beside a stage that nearly fits, and from the best of them.
constexpr int kNearSteps = 3, kOnwardSteps = 9;
/// Rounds of the latter, as long as each gains so much.
constexpr int kRounds = 5;
constexpr double kWorthARound = 10;
/// Misfit of the stage below which what is missing is small, and below which the fitted values are good
/// starts for everything but what is missing.
constexpr double kNested = 4, kNear = 1.5;
/// Share of the best one's first gain from which a hypothesis is fitted on.
constexpr double kFair = 0.2;
/// Fall of chi2 below which a hypothesis is not worth a fit: half the evidence asked for.
constexpr double kHopeless = 20;
/// Of the standard amplitude: where the answer is straight; the least that a start has.
constexpr double kSmall = 0.01, kLeastShare = 1e-3;

/// A hypothesis with its starts: its standard values, then draws in order of what they leave before any fit.
/// What leaves least may be what hardly acts.
struct Candidate {
  Hypothesis hypothesis;
  std::vector<sim::Plant> starts;
  /// The stage as fitted, with each start: its misfit, and all free parameters. The standard start first, the
  /// others as they suit the stage.
  std::vector<std::pair<double, std::vector<double>>> nested = {};
  double promise = 0;  ///< by how much chi2 would fall, by the score test
};

class Searcher {
 public:
  Searcher(const Stage& stage, const SearchProgress& report) : stage_(stage), report_(report) {
    if (stage.fit.misfit() < kNear) score_.emplace(stage.events, stage.plant, stage.conventions, stage.fit);
  }

  std::vector<Judgement> run() {
    const auto candidates = screened();
    std::vector<Judgement> tried(candidates.size());
    if (score_) {
      each(candidates, "fit ", [&](std::size_t i) {
        tried[i] = candidates[i].nested.empty() ? hopeless(candidates[i]) : near(candidates[i]);
      });
    } else {
      std::vector<std::vector<Fit>> begun(candidates.size());
      each(candidates, "first steps ", [&](std::size_t i) { begun[i] = first_steps(candidates[i]); });
      const auto onward = promising(candidates, begun);
      each(candidates, "fit ", [&](std::size_t i) {
        tried[i] = onward[i] ? more_steps(candidates[i], begun[i]) : judgement(candidates[i], begun[i]);
      });
    }
    std::erase_if(tried, [](const Judgement& j) { return j.fit.events.empty(); });
    std::ranges::sort(tried, std::greater<>(), &Judgement::gain);
    return tried;
  }

 private:
  template <class F>
  void each(const std::vector<Candidate>& candidates, const std::string& what, F act) const {
    int done = 0;
    std::mutex progress;
#pragma omp parallel for schedule(dynamic) num_threads(stage_.threads)
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      act(i);
      const std::lock_guard lock(progress);
      report(what + candidates[i].hypothesis.name, ++done, candidates.size());
    }
  }
  /// Every hypothesis that acts here.
  std::vector<Candidate> screened() const {
    auto all = all_hypotheses(stage_.plant, stage_.conventions);
    std::vector<Candidate> candidates(all.size());
    int done = 0;
    std::mutex progress;
#pragma omp parallel for schedule(dynamic) num_threads(stage_.threads)
    for (std::size_t i = 0; i < all.size(); ++i) {
      bring(all[i]);
      if (score_)
        score(all[i], candidates[i]);
      else
        screen(all[i], candidates[i]);
      candidates[i].hypothesis = std::move(all[i]);
      const std::lock_guard lock(progress);
      report("hypotheses", ++done, all.size());
    }
    std::erase_if(candidates, [](const Candidate& c) { return c.starts.empty(); });
    return candidates;
  }
  /// What earlier stages brought is free in this hypothesis too.
  void bring(Hypothesis& h) const {
    h.with = stage_.with;
    for (const FreeParameter& f : stage_.own) {
      const int block = find_block(h.plant, block_effect(stage_.plant, f.block));
      h.free.push_back({block, f.index, f.spread});
      const double value = parameter_value(stage_.plant, f.block, f.index);
      for (auto& start : h.starts) start.push_back(value);
    }
  }

  void screen(const Hypothesis& h, Candidate& c) const {
    struct Start {
      double misfit;
      sim::Plant plant;
    };
    std::vector<Start> starts;
    bool acts = false;
    for (const auto& values : h.starts | std::views::take(kScreened)) {
      Start s{0, started(h, values)};
      if (answer(s.plant, h, s.misfit, acts)) starts.push_back(std::move(s));
    }
    if (!starts.empty()) std::ranges::sort(starts.begin() + 1, starts.end(), {}, &Start::misfit);
    if (acts && !starts.empty()) {
      nest(h, c);
      for (auto& s : starts) c.starts.push_back(std::move(s.plant));
    }
  }
  /// The stage as fitted, with this start: all free parameters.
  std::vector<double> beside_fit(const Hypothesis& h, const std::vector<double>& start) const {
    sim::Plant plant = started(h, start);
    for (const auto& p : stage_.fit.parameters) {
      const int block = find_block(plant, block_effect(stage_.plant, p.where.block));
      parameter_value(plant, block, p.where.index) = p.value;
    }
    return values_of(plant, free_of(h, stage_.spread));
  }
  static sim::Plant with_values(const Hypothesis& h, const std::vector<FreeParameter>& free,
                                const std::vector<double>& values) {
    sim::Plant plant = h.plant;
    for (std::size_t i = 0; i < free.size(); ++i)
      parameter_value(plant, free[i].block, free[i].index) = values[i];
    return plant;
  }
  /// Starts beside what was fitted, the standard one first, then as they suit the stage.
  void nest(const Hypothesis& h, Candidate& c) const {
    const auto free = free_of(h, stage_.spread);
    for (const auto& start : h.starts | std::views::take(kScreened)) {
      auto values = beside_fit(h, start);
      double misfit = 0;
      bool acts = true;
      if (answer(with_values(h, free, values), h, misfit, acts))
        c.nested.emplace_back(misfit, std::move(values));
    }
    if (!c.nested.empty()) std::ranges::sort(c.nested.begin() + 1, c.nested.end());
  }
  /// Parameters that switch the effect off at their neutral value, by their place in the free ones. Off means
  /// a thousandth of the standard values' answer: more states make other steps.
  std::vector<std::size_t> amplitudes(const Hypothesis& h, const std::vector<double>& standard) const {
    const auto free = free_of(h, stage_.spread);
    std::vector<std::size_t> found;
    const double whole = moves(h, with_values(h, free, standard));
    for (std::size_t i = free.size() - h.free.size(); i < free.size(); ++i) {
      const double neutral = parameter_record(h.plant, free[i].block, free[i].index).neutral;
      if (!(neutral < standard[i]) && !(neutral > standard[i])) continue;
      auto off = standard;
      off[i] = neutral;
      if (moves(h, with_values(h, free, off)) < 1e-6 * whole) found.push_back(i);
    }
    return found;
  }
  /// Squared change of the first event's answer, in units of noise; NaN where it cannot be run.
  double moves(const Hypothesis& h, const sim::Plant& plant) const {
    const FitEvent& e = stage_.events.front();
    const EventFit& at = stage_.fit.events.front();
    try {
      const VoltageCurve curve(e.played(), switchings_at(e, at.state));
      Drive run = drive_at(plant, h.conventions, e, at.state);
      run.curve = &curve;
      const Response r = observe(run);
      double square = 0;
      for (std::size_t c = 0; c < e.channels.size(); ++c)
        for (std::size_t k = 0; k < r.of(e.channels[c]).size(); ++k)
          square +=
              std::pow((r.of(e.channels[c])[k] - at.model[c][k]) / e.noise[static_cast<Eigen::Index>(c)], 2);
      return square;
    } catch (const InputError&) {
      return std::nan("");
    }
  }
  /// Score test at the neutral point: each start as small as a first step along its amplitude would make it,
  /// those with most to gain first, the standard one before them. Nothing to gain: no starts, not worth a
  /// fit.
  void score(const Hypothesis& h, Candidate& c) const {
    const auto free = free_of(h, stage_.spread);
    const auto standard = beside_fit(h, h.starts.front());
    const auto which = amplitudes(h, standard);
    const auto at = [&](std::vector<double> values, double share) {
      for (const std::size_t i : which) {
        const double neutral = parameter_record(h.plant, free[i].block, free[i].index).neutral;
        values[i] = neutral + share * (values[i] - neutral);
      }
      return values;
    };
    std::vector<ScoreTest::Change> changes;
    std::vector<std::pair<double, std::vector<double>>> starts;
    for (const auto& start : h.starts) {
      if (starts.size() == kScored) break;
      const auto values = beside_fit(h, start);
      auto whole = score_->change_to(with_values(h, free, values), h.conventions);
      if (!whole) continue;
      double gain = whole->gain(), share = std::clamp(whole->share(), kLeastShare, 1.0);
      changes.push_back(std::move(*whole));
      std::vector<Direction> along;
      for (std::size_t i = free.size() - h.free.size(); i < free.size(); ++i) {
        const double neutral = parameter_record(h.plant, free[i].block, free[i].index).neutral;
        const bool asked = which.empty() ? !std::isnan(neutral) : std::ranges::count(which, i) > 0;
        if (asked)
          along.push_back({Direction::Kind::parameter, free[i].block, free[i].index, values[i] - neutral});
      }
      if (!along.empty())
        for (auto& slope : score_->slopes(with_values(h, free, at(values, kSmall)), h.conventions, along)) {
          if (!which.empty() && slope.gain() > gain)
            gain = slope.gain(), share = std::clamp(slope.share(), kLeastShare, 1.0);
          changes.push_back(std::move(slope));
        }
      starts.emplace_back(-gain, at(values, share));
    }
    c.promise = score_->joint_gain(changes);
    if (starts.empty() || std::ranges::none_of(changes, [](const auto& x) { return x.square > 0; })) return;
    c.starts = {started(h, h.starts.front())};
    // a few large changes say little of a small one
    if (c.promise < kHopeless && (!which.empty() || starts.size() >= std::min(h.starts.size(), kScored)))
      return;
    std::ranges::sort(starts);
    if (starts.size() >= kTries) starts.resize(kTries - 1);
    c.nested.emplace_back(0.0, standard);
    std::ranges::move(starts, std::back_inserter(c.nested));
  }
  Fit attempt(const Candidate& c, const sim::Plant& start, const FitOptions& o) const {
    return fit(start, c.hypothesis.conventions, stage_.events, free_of(c.hypothesis, stage_.spread), o);
  }
  /// From the standard values and from three draws, in the order of the starts.
  std::vector<Fit> first_steps(const Candidate& c) const {
    FitOptions o;
    o.errors = false;
    o.iterations = kFirstSteps;
    std::vector<Fit> fits;
    for (std::size_t k = 0; k < std::min(c.starts.size(), kTries); ++k)
      fits.push_back(attempt(c, c.starts[k], o));
    return fits;
  }
  /// Those whose first steps gain a fair share of what the best one's do, and the rivals of its slot.
  std::vector<char> promising(const std::vector<Candidate>& candidates,
                              const std::vector<std::vector<Fit>>& begun) const {
    std::vector<double> gains;
    for (const auto& fits : begun) {
      double gain = -std::numeric_limits<double>::infinity();
      for (const Fit& f : fits) gain = std::max(gain, penalised(stage_.fit) - penalised(f));
      gains.push_back(gain);
    }
    const auto best = std::ranges::max_element(gains);
    std::vector<char> onward;
    for (std::size_t i = 0; i < gains.size(); ++i) {
      const int slot = candidates[static_cast<std::size_t>(best - gains.begin())].hypothesis.slot;
      onward.push_back(*best <= 0 || gains[i] >= kFair * *best ||
                       (slot >= 0 && candidates[i].hypothesis.slot == slot));
    }
    return onward;
  }
  /// Onward from the best draw, and from the standard values: these are not left out for being slow, draws
  /// that hardly act always look better at first. Beliefs are about the start, not about where its first
  /// steps led.
  Judgement more_steps(const Candidate& c, const std::vector<Fit>& begun) const {
    const auto free = free_of(c.hypothesis, stage_.spread);
    FitOptions o;
    o.errors = false;
    o.iterations = kMoreSteps;
    std::vector<Fit> fits;
    std::size_t best = 0;
    for (std::size_t k = 1; k < begun.size(); ++k)
      if (begun[k].failed.empty() && (best == 0 || penalised(begun[k]) < penalised(begun[best]))) best = k;
    for (const std::size_t k : {std::size_t{0}, best})
      if (begun[k].failed.empty() && (k > 0 || fits.empty()))
        fits.push_back(attempt(c, c.starts[k], continued(o, begun[k], free)));
    std::erase_if(fits, [](const Fit& f) { return !f.failed.empty(); });
    const bool worse =
        fits.empty() || penalised(*std::ranges::min_element(fits, {}, penalised)) > penalised(stage_.fit);
    if (!c.nested.empty() && (worse || stage_.fit.misfit() < kNested)) {
      o.iterations = kNestedSteps;
      o.values = std::ranges::min_element(c.nested)->second;
      o.start.clear();
      for (const auto& e : stage_.fit.events) o.start.push_back(e.state);
      if (Fit f = attempt(c, c.starts.front(), o); f.failed.empty()) fits.push_back(std::move(f));
    }
    return judgement(c, fits);
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
  /// Beside a stage that nearly fits, all else starts as that ended.
  Judgement near(const Candidate& c) const {
    const auto free = free_of(c.hypothesis, stage_.spread);
    FitOptions o;
    o.errors = false;
    o.iterations = kNearSteps;
    for (const auto& e : stage_.fit.events) o.start.push_back(e.state);
    std::vector<Fit> fits;
    for (std::size_t k = 0; k < std::min(c.nested.size(), kTries); ++k) {
      o.values = c.nested[k].second;
      if (Fit f = fit(c.starts.front(), c.hypothesis.conventions, stage_.events, free, o); f.failed.empty())
        fits.push_back(std::move(f));
    }
    if (fits.empty()) return judgement(c, fits);
    o.iterations = kOnwardSteps;
    Fit best = *std::ranges::min_element(fits, {}, penalised);
    for (int round = 0; round < kRounds; ++round) {
      const Fit from = std::exchange(best, fit(c.starts.front(), c.hypothesis.conventions, stage_.events,
                                               free, continued(o, best, free)));
      if (!best.failed.empty() || best.converged || penalised(best) > penalised(from) - kWorthARound) break;
    }
    fits.push_back(std::move(best));
    return judgement(c, fits);
  }
  /// The best of the fits.
  Judgement judgement(const Candidate& c, std::vector<Fit> fits) const {
    Judgement j;
    j.hypothesis = c.hypothesis;
    std::erase_if(fits, [](const Fit& f) { return !f.failed.empty(); });
    if (fits.empty()) return j;
    j.fit = with_errors(c, std::move(*std::ranges::min_element(fits, {}, penalised)));
    j.gain = criterion(stage_.fit) - criterion(j.fit);
    return j;
  }
  /// The same fit; its evidence needs the errors.
  Fit with_errors(const Candidate& c, Fit f) const {
    const auto free = free_of(c.hypothesis, stage_.spread);
    FitOptions o = continued({}, f, free);
    o.iterations = 0;
    Fit known = fit(c.starts.front(), c.hypothesis.conventions, stage_.events, free, o);
    if (!known.failed.empty()) return f;
    known.iterations = f.iterations;
    known.converged = f.converged;
    return known;
  }
  /// Misfit of a start, everything else as in the model; whether it acts at all.
  bool answer(const sim::Plant& plant, const Hypothesis& h, double& misfit, bool& acts) const {
    misfit = 0;
    try {
      for (const FitEvent& e : stage_.events) {
        const VoltageCurve curve(e.played(), e.switchings);
        Drive run = drive_at(plant, h.conventions, e, {});
        run.curve = &curve;
        const Response r = observe(run);
        if (!acts) {
          run.plant = &stage_.plant;
          run.conventions = stage_.conventions;
          acts = differ(r, observe(run), e);
        }
        misfit += misfit_of(r, e);
      }
    } catch (const InputError&) {
      return false;
    }
    return std::isfinite(misfit);
  }
  /// Whether two answers differ by a hundredth of the noise somewhere.
  static bool differ(const Response& x, const Response& y, const FitEvent& e) {
    for (std::size_t c = 0; c < e.channels.size(); ++c)
      for (std::size_t k = 0; k < x.of(e.channels[c]).size(); ++k)
        if (std::abs(x.of(e.channels[c])[k] - y.of(e.channels[c])[k]) >
            1e-2 * e.noise[static_cast<Eigen::Index>(c)])
          return true;
    return false;
  }
  static double misfit_of(const Response& r, const FitEvent& e) {
    double sum = 0;
    for (std::size_t c = 0; c < e.channels.size(); ++c)
      for (std::size_t k = 0; k < r.of(e.channels[c]).size(); ++k)
        if (e.compared(k))
          sum += std::pow(
              (r.of(e.channels[c])[k] - e.measured(e.channels[c])[k]) / e.noise[static_cast<Eigen::Index>(c)],
              2);
    return sum;
  }
  void report(const std::string& what, int done, std::size_t total) const {
    if (!report_) return;
    report_(stage_.with.empty() ? what : what + " beside " + stage_.with, done, static_cast<int>(total));
  }

  const Stage& stage_;
  const SearchProgress& report_;
  std::optional<ScoreTest> score_;  ///< where the stage nearly fits
};

}  // namespace

std::vector<Judgement> try_hypotheses(const Stage& stage, const SearchProgress& report) {
  return Searcher(stage, report).run();
}

Stage after(const Stage& stage, const Judgement& j) {
  sim::Plant plant = j.hypothesis.plant;
  for (const auto& f : j.hypothesis.free)
    parameter_value(plant, f.block, f.index) = parameter_value(j.fit.plant, f.block, f.index);
  return {stage.events, std::move(plant),  j.hypothesis.conventions,
          j.fit,        j.hypothesis.free, j.hypothesis.name,
          stage.spread, stage.threads};
}

}  // namespace swingbank::validate
