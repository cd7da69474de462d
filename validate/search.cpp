#include "validate/search.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "validate/instruments.hpp"

namespace swingbank::validate {
namespace {

/// Starts that are tried, and steps of the fits: from each, from the best two of them, and from the stage's
/// fit.
constexpr std::size_t kTries = 4;
constexpr int kFirstSteps = 4, kMoreSteps = 8, kNestedSteps = 12;
/// Steps from each start beside a stage that nearly fits, and from the best of them.
constexpr int kNearSteps = 3, kOnwardSteps = 9;
/// Rounds of the latter, as long as each gains so much.
constexpr int kRounds = 5;
constexpr double kWorthARound = 10;
/// Misfit of the stage below which what is missing is small, and below which the fitted values are good
/// starts for everything but what is missing.
constexpr double kNested = 4, kNear = 1.5;

/// A hypothesis with its starts: its standard values, then draws in order of what they leave before any fit.
/// What leaves least may be what hardly acts.
struct Candidate {
  Hypothesis hypothesis;
  std::vector<sim::Plant> starts;
  /// The stage as fitted, with each start: its misfit, and all free parameters. The standard start first, the
  /// others as they suit the stage.
  std::vector<std::pair<double, std::vector<double>>> nested = {};
};

/// Index in `plant` of the block with that effect.
int block_with(const sim::Plant& plant, const sim::Effect& effect) {
  int block = 0;
  while (&block_effect(plant, block) != &effect) ++block;
  return block;
}

/// Where `f` ended, its beliefs as they were.
FitOptions continued(FitOptions o, const Fit& f, const std::vector<FreeParameter>& free) {
  o.values = values_of(f.plant, free);
  o.start.clear();
  for (const auto& e : f.events) o.start.push_back(e.state);
  return o;
}

class Searcher {
 public:
  Searcher(const Stage& stage, const SearchProgress& report) : stage_(stage), report_(report) {}

  std::vector<Judgement> run() {
    const auto candidates = screened();
    std::vector<Judgement> tried(candidates.size());
    int done = 0;
    std::mutex progress;
#pragma omp parallel for schedule(dynamic) num_threads(stage_.threads)
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      tried[i] = quick(candidates[i]);
      const std::lock_guard lock(progress);
      report("fit " + candidates[i].hypothesis.name, ++done, candidates.size());
    }
    std::erase_if(tried, [](const Judgement& j) { return j.fit.events.empty(); });
    std::ranges::sort(tried, std::greater<>(), &Judgement::gain);
    return tried;
  }

 private:
  /// Every hypothesis that acts here.
  std::vector<Candidate> screened() const {
    auto all = all_hypotheses(stage_.plant, stage_.conventions);
    std::vector<Candidate> candidates(all.size());
    int done = 0;
    std::mutex progress;
#pragma omp parallel for schedule(dynamic) num_threads(stage_.threads)
    for (std::size_t i = 0; i < all.size(); ++i) {
      bring(all[i]);
      candidates[i] = screen(std::move(all[i]));
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
      const int block = block_with(h.plant, block_effect(stage_.plant, f.block));
      h.free.push_back({block, f.index, f.spread});
      const double value = parameter_value(stage_.plant, f.block, f.index);
      for (auto& start : h.starts) start.push_back(value);
    }
  }

  Candidate screen(Hypothesis h) const {
    Candidate c;
    struct Start {
      double misfit;
      sim::Plant plant;
    };
    std::vector<Start> starts;
    bool acts = false;
    for (const auto& values : h.starts) {
      Start s{0, started(h, values)};
      if (answer(s.plant, h, s.misfit, acts)) starts.push_back(std::move(s));
    }
    if (!starts.empty()) std::ranges::sort(starts.begin() + 1, starts.end(), {}, &Start::misfit);
    if (acts && !starts.empty()) {
      nest(h, c);
      for (auto& s : starts) c.starts.push_back(std::move(s.plant));
    }
    c.hypothesis = std::move(h);
    return c;
  }
  /// Where the stage nearly fits, what is missing is small: its fitted values are the start then.
  void nest(const Hypothesis& h, Candidate& c) const {
    for (const auto& values : h.starts) {
      sim::Plant plant = started(h, values);
      for (const auto& p : stage_.fit.parameters) {
        const int block = block_with(plant, block_effect(stage_.plant, p.where.block));
        parameter_value(plant, block, p.where.index) = p.value;
      }
      double misfit = 0;
      bool acts = true;
      if (answer(plant, h, misfit, acts))
        c.nested.emplace_back(misfit, values_of(plant, free_of(h, stage_.spread)));
    }
    if (c.nested.empty()) return;
    std::ranges::sort(c.nested.begin() + 1, c.nested.end());
    if (stage_.fit.misfit() < kNear) scale(h, c);
  }
  /// Parameters that switch the effect off at their neutral value, by their place in the free ones. Off means
  /// a thousandth of the standard values' answer: more states make other steps.
  std::vector<std::size_t> amplitudes(const Hypothesis& h, const Candidate& c) const {
    const auto free = free_of(h, stage_.spread);
    const auto& standard = c.nested.front().second;
    double along = 0, whole = 0;
    std::vector<std::size_t> found;
    if (!project(h, with_values(h, free, standard), along, whole)) return found;
    for (std::size_t i = free.size() - h.free.size(); i < free.size(); ++i) {
      const double neutral = parameter_record(h.plant, free[i].block, free[i].index).neutral;
      if (!(neutral < standard[i]) && !(neutral > standard[i])) continue;
      auto off = standard;
      off[i] = neutral;
      double left = 0;
      if (project(h, with_values(h, free, off), along, left) && left < 1e-6 * whole) found.push_back(i);
    }
    return found;
  }
  static sim::Plant with_values(const Hypothesis& h, const std::vector<FreeParameter>& free,
                                const std::vector<double>& values) {
    sim::Plant plant = h.plant;
    for (std::size_t i = 0; i < free.size(); ++i)
      parameter_value(plant, free[i].block, free[i].index) = values[i];
    return plant;
  }
  /// Score test at the neutral point: each start as small as a first step along its amplitude would make it,
  /// those with most to gain first.
  void scale(const Hypothesis& h, Candidate& c) const {
    constexpr double kSmall = 0.01;  // of the amplitude: the answer is straight
    const auto which = amplitudes(h, c);
    if (which.empty()) return;
    const auto free = free_of(h, stage_.spread);
    const auto at = [&](std::vector<double> values, double share) {
      for (const std::size_t i : which) {
        const double neutral = parameter_record(h.plant, free[i].block, free[i].index).neutral;
        values[i] = neutral + share * (values[i] - neutral);
      }
      return values;
    };
    std::vector<std::pair<double, std::vector<double>>> scaled;
    for (const auto& [misfit, values] : c.nested) {
      double along = 0, square = 0;
      if (!project(h, with_values(h, free, at(values, kSmall)), along, square) || !(square > 0)) continue;
      const double share = std::clamp(-along / square * kSmall, 1e-3, 1.0);
      scaled.emplace_back(along < 0 ? -along * along / square : 0.0, at(values, share));
    }
    std::ranges::sort(scaled);
    if (scaled.size() >= kTries) scaled.resize(kTries - 1);
    c.nested.insert(c.nested.begin() + 1, std::make_move_iterator(scaled.begin()),
                    std::make_move_iterator(scaled.end()));
  }
  /// Change of the stage's answer to that of `plant`, whitened: times the stage's residual, times itself.
  bool project(const Hypothesis& h, const sim::Plant& plant, double& along, double& square) const {
    try {
      for (std::size_t i = 0; i < stage_.events.size(); ++i) {
        const FitEvent& e = stage_.events[i];
        const EventFit& at = stage_.fit.events[i];
        auto switchings = e.switchings;
        for (std::size_t k = 0; k < switchings.size(); ++k) switchings[k].time = at.state.switchings[k];
        const VoltageCurve curve(e.played(), switchings);
        Drive run{.plant = &plant, .conventions = h.conventions, .record = &e.record, .curve = &curve};
        run.start = e.start;
        run.start.P += at.state.P;
        run.start.Q += at.state.Q;
        run.angle = at.state.angle;
        run.speed = at.state.speed;
        run.tolerance = 1e-5;
        run.least_step = e.record.step() / 40;
        run.step_limit = 15 * e.record.samples();
        EventFit moved;
        compare(e, observe(run), moved);
        for (std::size_t ch = 0; ch < moved.residual.size(); ++ch)
          for (std::size_t k = 0; k < moved.residual[ch].size(); ++k) {
            const double by = moved.residual[ch][k] - at.residual[ch][k];
            along += by * at.residual[ch][k];
            square += by * by;
          }
      }
    } catch (const InputError&) {
      return false;
    }
    return true;
  }
  /// From the standard values, and from the draw that a few steps show to be the best. The standard ones are
  /// not left out for being slow: draws that hardly act always look better at first.
  Judgement quick(const Candidate& c) const {
    if (stage_.fit.misfit() < kNear && !c.nested.empty()) return near(c);
    const auto free = free_of(c.hypothesis, stage_.spread);
    const auto attempt = [&](const sim::Plant& start, const FitOptions& o) {
      return fit(start, c.hypothesis.conventions, stage_.events, free, o);
    };
    FitOptions o;
    o.errors = false;
    o.iterations = kFirstSteps;
    std::vector<Fit> fits;
    const sim::Plant* best = nullptr;
    Fit first;
    const std::size_t tries = std::min(c.starts.size(), kTries);
    for (std::size_t k = 1; k < tries; ++k) {
      Fit f = attempt(c.starts[k], o);
      if (!f.failed.empty() || (best && penalised(f) >= penalised(first))) continue;
      first = std::move(f);
      best = &c.starts[k];
    }
    o.iterations = kMoreSteps;  // beliefs are about the start, not about where its first steps led
    if (best) fits.push_back(attempt(*best, continued(o, first, free)));
    o.iterations = kFirstSteps + kMoreSteps;
    fits.push_back(attempt(c.starts.front(), o));
    std::erase_if(fits, [](const Fit& f) { return !f.failed.empty(); });
    const bool worse =
        fits.empty() || penalised(*std::ranges::min_element(fits, {}, penalised)) > penalised(stage_.fit);
    if (!c.nested.empty() && (worse || stage_.fit.misfit() < kNested)) {
      o.iterations = kNestedSteps;
      o.values = std::ranges::min_element(c.nested)->second;
      o.start.clear();
      for (const auto& e : stage_.fit.events) o.start.push_back(e.state);
      if (Fit f = attempt(c.starts.front(), o); f.failed.empty()) fits.push_back(std::move(f));
    }
    return judgement(c, fits, tries);
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
    if (fits.empty()) return judgement(c, fits, kTries);
    o.iterations = kOnwardSteps;
    Fit best = *std::ranges::min_element(fits, {}, penalised);
    for (int round = 0; round < kRounds; ++round) {
      const Fit from = std::exchange(best, fit(c.starts.front(), c.hypothesis.conventions, stage_.events,
                                               free, continued(o, best, free)));
      if (!best.failed.empty() || best.converged || penalised(best) > penalised(from) - kWorthARound) break;
    }
    fits.push_back(std::move(best));
    return judgement(c, fits, kTries);
  }
  /// The best of the fits; starts from `tried` on remain.
  Judgement judgement(const Candidate& c, std::vector<Fit>& fits, std::size_t tried) const {
    Judgement j;
    j.hypothesis = c.hypothesis;
    j.starts.assign(c.starts.begin() + static_cast<std::ptrdiff_t>(std::min(tried, c.starts.size())),
                    c.starts.end());
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
        Drive run{.plant = &plant, .conventions = h.conventions, .record = &e.record, .curve = &curve};
        run.start = e.start;
        run.tolerance = 1e-5;
        run.least_step = e.record.step() / 40;
        run.step_limit = 15 * e.record.samples();
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
};

}  // namespace

std::vector<Judgement> try_hypotheses(const Stage& stage, const SearchProgress& report) {
  return Searcher(stage, report).run();
}

void try_further(const Stage& stage, Judgement& j) {
  constexpr std::size_t kFurther = 4;
  const auto free = free_of(j.hypothesis, stage.spread);
  FitOptions o;
  o.iterations = 10;
  for (std::size_t k = 0; k < std::min(kFurther, j.starts.size()); ++k)
    if (Fit f = fit(j.starts[k], j.hypothesis.conventions, stage.events, free, o);
        f.failed.empty() && penalised(f) < penalised(j.fit))
      j.fit = std::move(f);
  j.starts.clear();
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
