#include "validate/diagnose.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <mutex>

#include "validate/instruments.hpp"

namespace swingbank::validate {
namespace {

/// Rivals within this evidence cannot be told apart.
constexpr double kApart = 12;
/// Misfit at which a first start needs no second.
constexpr double kSettled = 1.3;
/// Misfit of the base below which what is missing is small.
constexpr double kNested = 4;

std::string capitalised(std::string text) {
  if (!text.empty()) text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  return text;
}

class Diagnoser {
 public:
  Diagnoser(const PlantModel& model, std::vector<Record> records, const DiagnoseOptions& options)
      : model_(model), options_(options) {
    if (records.size() < 2)
      throw InputError({fmt::format("{} event", records.size()), "--records",
                        "an effect is believed only if it predicts an event that it was not fitted to",
                        "give records of two events or more"});
    result_.events = prepare_events(model, std::move(records), {.measured_states = options.measured_states});
    threads_ = options.threads > 0 ? options.threads : omp_get_num_procs();
  }

  Diagnosis run() {
    const auto begin = std::chrono::steady_clock::now();
    fit_base();
    infer_inputs();
    search(model_.plant, model_.conventions, result_.base, result_.ranked);
    settle();
    result_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return std::move(result_);
  }

 private:
  void fit_base() {
    report("base", 0, 1);
    FitOptions o;
    const auto free = free_parameters(model_.plant, options_.spread);
    result_.base = fit(model_.plant, model_.conventions, result_.events, free, o);
    if (result_.base.failed.empty() && result_.base.misfit() < kNested) {
      PlantModel fitted = model_;
      fitted.plant = result_.base.plant;
      measure_noise(fitted, result_.events);
      o.values = values_of(result_.base.plant, free);
      for (const auto& e : result_.base.events) o.start.push_back(e.state);
      result_.base = fit(model_.plant, model_.conventions, result_.events, free, o);
    }
    if (!result_.base.failed.empty())
      throw InputError({"the model cannot be fitted", model_.origin, result_.base.failed,
                        "correct the model or leave the record out"});
    held_out_base_ = hold_out(trial(), model_.plant, model_.conventions, {}, result_.base);
    report("base", 1, 1);
  }
  void infer_inputs() {
#pragma omp parallel for schedule(dynamic) num_threads(threads_)
    for (int i = 0; i < 2; ++i) {
      MissingInput& m = i == 0 ? result_.torque : result_.field;
      m = infer_input(i == 0 ? InputKind::torque : InputKind::field, model_.plant, model_.conventions,
                      result_.events, options_.spread, {});
    }
    report("missing input", 1, 1);
  }

  /// A hypothesis with its starts in order of what they leave, before any fit.
  struct Candidate {
    Hypothesis hypothesis;
    std::vector<sim::Plant> starts;
    std::vector<double> nested =
        {};                 ///< free parameters: the base as fitted, and the start that suits it best
    double misfit = 1e300;  ///< of the best start
  };

  /// Tries every hypothesis that may be added to `base`, best first.
  void search(const sim::Plant& base, const sim::Conventions& conventions, const Fit& base_fit,
              std::vector<Judgement>& ranked) {
    auto candidates = screened(base, conventions);
    std::vector<Judgement> judged(candidates.size());
    int done = 0;
    std::mutex progress;
#pragma omp parallel for schedule(dynamic) num_threads(threads_)
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      judged[i] = quick(candidates[i], base_fit);
      const std::lock_guard lock(progress);
      report("fit " + candidates[i].hypothesis.name, ++done, static_cast<int>(candidates.size()));
    }
    std::erase_if(judged, [](const Judgement& j) { return j.fit.events.empty(); });
    std::ranges::sort(judged, std::greater<>(), &Judgement::gain);
    const int leading = std::min(options_.leading, static_cast<int>(judged.size()));
    done = 0;
#pragma omp parallel for schedule(dynamic) num_threads(threads_)
    for (int i = 0; i < leading; ++i) {
      judge(trial(), base_fit, held_out_base_, judged[static_cast<std::size_t>(i)]);
      const std::lock_guard lock(progress);
      report("unseen events " + judged[static_cast<std::size_t>(i)].hypothesis.name, ++done, leading);
    }
    std::ranges::stable_sort(judged, [](const Judgement& x, const Judgement& y) {
      return x.accepted != y.accepted ? x.accepted : x.gain > y.gain;
    });
    ranked = std::move(judged);
  }

  /// Every hypothesis that acts here; of those that compete for one slot the simplest and the two whose
  /// starts answer best.
  std::vector<Candidate> screened(const sim::Plant& base, const sim::Conventions& conventions) {
    auto all = all_hypotheses(base, conventions);
    std::vector<Candidate> candidates(all.size());
    int done = 0;
    std::mutex progress;
#pragma omp parallel for schedule(dynamic) num_threads(threads_)
    for (std::size_t i = 0; i < all.size(); ++i) {
      candidates[i] = screen(std::move(all[i]), base);
      const std::lock_guard lock(progress);
      report("hypotheses", ++done, static_cast<int>(all.size()));
    }
    std::erase_if(candidates, [](const Candidate& c) { return c.starts.empty(); });
    std::ranges::stable_sort(candidates, {}, &Candidate::misfit);
    std::map<int, std::vector<std::size_t>> rivals;
    for (std::size_t i = 0; i < candidates.size(); ++i)
      if (candidates[i].hypothesis.slot >= 0) rivals[candidates[i].hypothesis.slot].push_back(i);
    std::vector<char> keep(candidates.size(), 1);
    for (const auto& [slot, those] : rivals) {
      const auto simplest = std::ranges::min_element(
          those, {}, [&](std::size_t i) { return candidates[i].hypothesis.free.size(); });
      for (std::size_t k = 2; k < those.size(); ++k)
        if (those[k] != *simplest) {
          keep[those[k]] = 0;
          result_.outrun.push_back(candidates[those[k]].hypothesis.name);
        }
    }
    std::vector<Candidate> kept;
    for (std::size_t i = 0; i < candidates.size(); ++i)
      if (keep[i]) kept.push_back(std::move(candidates[i]));
    return kept;
  }
  Candidate screen(Hypothesis h, const sim::Plant& base) const {
    Candidate c;
    struct Start {
      double misfit;
      sim::Plant plant;
    };
    std::vector<Start> starts;
    bool acts = false;
    for (const auto& values : h.starts) {
      Start s{0, started(h, values)};
      if (answer(s.plant, h, base, s.misfit, acts)) starts.push_back(std::move(s));
    }
    std::ranges::sort(starts, {}, &Start::misfit);
    if (acts && result_.base.misfit() < kNested) nest(h, base, c);
    if (acts && !starts.empty()) {
      c.misfit = starts.front().misfit;
      for (auto& s : starts) c.starts.push_back(std::move(s.plant));
    }
    c.hypothesis = std::move(h);
    return c;
  }

  std::vector<FreeParameter> free_of(const Hypothesis& h) const {
    return validate::free_of(h, options_.spread);
  }
  /// Where the base nearly fits, what is missing is small: its fitted values are the start then.
  void nest(const Hypothesis& h, const sim::Plant& base, Candidate& c) const {
    double least = 1e300;
    for (const auto& values : h.starts) {
      sim::Plant plant = started(h, values);
      for (const auto& p : result_.base.parameters)
        for (const auto& f : free_of(h))
          if (block_effect(plant, f.block).name == p.block &&
              parameter_record(plant, f.block, f.index).name == p.name)
            parameter_value(plant, f.block, f.index) = p.value;
      double misfit = 0;
      bool acts = true;
      if (!answer(plant, h, base, misfit, acts) || misfit >= least) continue;
      least = misfit;
      c.nested = values_of(plant, free_of(h));
    }
  }
  /// A short fit from the best start, and from others if that does not settle it.
  Judgement quick(const Candidate& c, const Fit& base_fit) const {
    Judgement j;
    const auto free = free_of(c.hypothesis);
    const std::size_t tries = std::min<std::size_t>(c.starts.size(), 2);
    for (std::size_t k = 0; k < tries && (k == 0 || j.fit.events.empty() || j.fit.misfit() > kSettled); ++k) {
      FitOptions o;
      o.iterations = 8;
      Fit f = fit(c.starts[k], c.hypothesis.conventions, result_.events, free, o);
      if (f.failed.empty() && (j.fit.events.empty() || criterion(f) < criterion(j.fit))) j.fit = std::move(f);
    }
    if (!c.nested.empty()) {
      FitOptions o;
      o.iterations = 12;
      o.values = c.nested;
      for (const auto& e : base_fit.events) o.start.push_back(e.state);
      Fit f = fit(c.starts.front(), c.hypothesis.conventions, result_.events, free, o);
      if (f.failed.empty() && (j.fit.events.empty() || criterion(f) < criterion(j.fit))) j.fit = std::move(f);
    }
    if (!j.fit.events.empty()) j.gain = criterion(base_fit) - criterion(j.fit);
    j.hypothesis = c.hypothesis;
    return j;
  }
  /// Misfit of a start, everything else as in the model; whether it acts at all.
  bool answer(const sim::Plant& plant, const Hypothesis& h, const sim::Plant& base, double& misfit,
              bool& acts) const {
    misfit = 0;
    try {
      for (const FitEvent& e : result_.events) {
        const VoltageCurve curve(e.played(), e.switchings);
        Drive run{.plant = &plant, .conventions = h.conventions, .record = &e.record, .curve = &curve};
        run.start = e.start;
        run.tolerance = 1e-5;
        run.least_step = e.record.step() / 40;
        run.step_limit = 15 * e.record.samples();
        const Response r = observe(run);
        if (!acts) {
          run.plant = &base;
          run.conventions = model_.conventions;
          const Response plain = observe(run);
          for (std::size_t c = 0; c < e.channels.size() && !acts; ++c)
            for (std::size_t k = 0; k < r.of(e.channels[c]).size() && !acts; ++k)
              acts = std::abs(r.of(e.channels[c])[k] - plain.of(e.channels[c])[k]) >
                     1e-2 * e.noise[static_cast<Eigen::Index>(c)];
        }
        for (std::size_t c = 0; c < e.channels.size(); ++c)
          for (std::size_t k = 0; k < r.of(e.channels[c]).size(); ++k)
            if (e.compared(k))
              misfit += std::pow((r.of(e.channels[c])[k] - e.measured(e.channels[c])[k]) /
                                     e.noise[static_cast<Eigen::Index>(c)],
                                 2);
      }
    } catch (const InputError&) {
      return false;
    }
    return std::isfinite(misfit);
  }

  [[nodiscard]] Trial trial() const { return {result_.events, options_.spread, options_.adequate}; }

  void settle() {
    const auto& r = result_.ranked;
    const bool quiet = result_.base.misfit() <= options_.adequate;
    if (!r.empty() && r.front().accepted) return name_best();
    if (quiet) {
      result_.verdict = Verdict::adequate;
      result_.sentence = fmt::format(
          "The model is adequate: after refitting its parameters nothing but noise is left (chi2 per value "
          "{:.3f}), and no effect in the list improves it.",
          result_.base.misfit());
      return;
    }
    result_.verdict = Verdict::unexplained;
    const double t = result_.torque.misfit(), f = result_.field.misfit();
    result_.side = t < f ? Side::mechanical : Side::excitation;
    result_.sentence = fmt::format(
        "None of the {} known effects explains the records (chi2 per value {:.2f} at best {:.2f}). A missing "
        "{} would (chi2 per value {:.2f}); its course is shown.",
        r.size(), result_.base.misfit(), r.empty() ? result_.base.misfit() : r.front().fit.misfit(),
        t < f ? "torque" : "field voltage", std::min(t, f));
    result_.laws =
        search_laws({model_, trial(), result_.base, held_out_base_, result_.torque, result_.field, threads_},
                    options_.progress);
    if (result_.laws.found()) {
      result_.side = result_.laws.found()->judgement.hypothesis.side;
      result_.sentence = law_sentence(result_.laws, r.size());
    }
  }
  void name_best() {
    const Judgement& best = result_.ranked.front();
    result_.side = best.hypothesis.side;
    result_.effects = {best.hypothesis.name};
    for (const auto& j : result_.ranked)
      if (j.accepted && &j != &best && best.gain - j.gain < kApart)
        result_.equivalent.push_back(j.hypothesis.name);
    double before = 0, after = 0;
    for (const auto& h : best.held_out) {
      before += h.before / static_cast<double>(best.held_out.size());
      after += h.after / static_cast<double>(best.held_out.size());
    }
    result_.verdict = result_.equivalent.empty() ? Verdict::missing : Verdict::confusable;
    std::string rivals;
    for (const auto& name : result_.equivalent) rivals += (rivals.empty() ? "" : ", ") + name;
    result_.sentence = fmt::format(
        "{} is missing{}: on events it was not fitted to, the error falls from {:.1f} × noise to {:.2f} × "
        "noise.",
        capitalised(best.hypothesis.what),
        rivals.empty() ? "" : " (or " + rivals + ": these records cannot tell)", std::sqrt(before),
        std::sqrt(after));
  }
  void report(const std::string& what, int done, int total) const {
    if (options_.progress) options_.progress(what, done, total);
  }

  const PlantModel& model_;
  const DiagnoseOptions& options_;
  Diagnosis result_;
  std::vector<HeldOut> held_out_base_;
  int threads_;
};

}  // namespace

std::string_view verdict_name(Verdict verdict) {
  constexpr std::array<std::string_view, 4> names = {"adequate", "missing", "confusable", "unexplained"};
  return names[static_cast<std::size_t>(verdict)];
}

Diagnosis diagnose(const PlantModel& model, std::vector<Record> records, const DiagnoseOptions& options) {
  return Diagnoser(model, std::move(records), options).run();
}

}  // namespace swingbank::validate
