#include "validate/search.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include "validate/instruments.hpp"

namespace swingbank::validate {
namespace {

/// Misfit at which a first start needs no second.
constexpr double kSettled = 1.3;
/// Misfit of the stage below which what is missing is small.
constexpr double kNested = 4;
/// Rivals of one slot that are fitted: those whose starts answer best, and the simplest.
constexpr std::size_t kRivals = 4;

/// A hypothesis with its starts in order of what they leave, before any fit.
struct Candidate {
  Hypothesis hypothesis;
  std::vector<sim::Plant> starts;
  std::vector<double> nested =
      {};                 ///< free parameters: the stage as fitted, and the start that suits it best
  double misfit = 1e300;  ///< of the best start
};

/// Index in `plant` of the block with that effect.
int block_with(const sim::Plant& plant, const sim::Effect& effect) {
  int block = 0;
  while (&block_effect(plant, block) != &effect) ++block;
  return block;
}

class Searcher {
 public:
  Searcher(const Stage& stage, const SearchProgress& report) : stage_(stage), report_(report) {}

  Search run() {
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
    found_.tried = std::move(tried);
    return std::move(found_);
  }

 private:
  /// Every hypothesis that acts here, without those that rivals of their slot outrun.
  std::vector<Candidate> screened() {
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
    std::ranges::stable_sort(candidates, {}, &Candidate::misfit);
    return without_outrun(std::move(candidates));
  }
  std::vector<Candidate> without_outrun(std::vector<Candidate> candidates) {
    std::map<int, std::vector<const Candidate*>> rivals;
    for (const auto& c : candidates)
      if (c.hypothesis.slot >= 0) rivals[c.hypothesis.slot].push_back(&c);
    std::vector<Candidate> kept;
    for (auto& c : candidates) {
      const auto& those = rivals[c.hypothesis.slot];
      const auto size = [](const Candidate* r) { return r->hypothesis.free.size(); };
      const bool simplest = !those.empty() && *std::ranges::min_element(those, {}, size) == &c;
      const auto rank = std::ranges::find(those, &c) - those.begin();
      if (c.hypothesis.slot < 0 || simplest || rank < static_cast<std::ptrdiff_t>(kRivals))
        kept.push_back(c);
      else
        found_.outrun.push_back(c.hypothesis.name);
    }
    return kept;
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
    std::ranges::sort(starts, {}, &Start::misfit);
    if (acts && !starts.empty()) {
      nest(h, c);
      c.misfit = starts.front().misfit;
      for (auto& s : starts) c.starts.push_back(std::move(s.plant));
    }
    c.hypothesis = std::move(h);
    return c;
  }
  /// Where the stage nearly fits, what is missing is small: its fitted values are the start then.
  void nest(const Hypothesis& h, Candidate& c) const {
    double least = 1e300;
    for (const auto& values : h.starts) {
      sim::Plant plant = started(h, values);
      for (const auto& p : stage_.fit.parameters) {
        const int block = block_with(plant, block_effect(stage_.plant, p.where.block));
        parameter_value(plant, block, p.where.index) = p.value;
      }
      double misfit = 0;
      bool acts = true;
      if (!answer(plant, h, misfit, acts) || misfit >= least) continue;
      least = misfit;
      c.nested = values_of(plant, free_of(h, stage_.spread));
    }
  }
  /// A short fit from the best start, and from others if that does not settle it.
  Judgement quick(const Candidate& c) const {
    Judgement j;
    const auto free = free_of(c.hypothesis, stage_.spread);
    const auto attempt = [&](std::size_t start, const FitOptions& o) {
      Fit f = fit(c.starts[start], c.hypothesis.conventions, stage_.events, free, o);
      if (f.failed.empty() && (j.fit.events.empty() || criterion(f) < criterion(j.fit))) j.fit = std::move(f);
    };
    FitOptions o;
    o.iterations = 8;
    const std::size_t tries = std::min<std::size_t>(c.starts.size(), 2);
    for (std::size_t k = 0; k < tries && (k == 0 || j.fit.events.empty() || j.fit.misfit() > kSettled); ++k)
      attempt(k, o);
    const bool worse = j.fit.events.empty() || criterion(j.fit) > criterion(stage_.fit);
    if (!c.nested.empty() && (worse || stage_.fit.misfit() < kNested)) {
      o.iterations = 12;
      o.values = c.nested;
      for (const auto& e : stage_.fit.events) o.start.push_back(e.state);
      attempt(0, o);
    }
    if (!j.fit.events.empty()) j.gain = criterion(stage_.fit) - criterion(j.fit);
    j.hypothesis = c.hypothesis;
    if (c.starts.size() > tries)
      j.starts.assign(c.starts.begin() + static_cast<std::ptrdiff_t>(tries), c.starts.end());
    return j;
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
  Search found_;
};

}  // namespace

Search try_hypotheses(const Stage& stage, const SearchProgress& report) {
  return Searcher(stage, report).run();
}

void try_further(const Stage& stage, Judgement& j) {
  constexpr std::size_t kFurther = 4;
  const auto free = free_of(j.hypothesis, stage.spread);
  FitOptions o;
  o.iterations = 10;
  for (std::size_t k = 0; k < std::min(kFurther, j.starts.size()); ++k)
    if (Fit f = fit(j.starts[k], j.hypothesis.conventions, stage.events, free, o);
        f.failed.empty() && criterion(f) < criterion(j.fit))
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
