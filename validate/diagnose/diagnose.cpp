#include "validate/diagnose/diagnose.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <chrono>
#include <span>

#include "base/in_parallel.hpp"
#include "base/stop_signal.hpp"
#include "validate/diagnose/detail/base.hpp"
#include "validate/diagnose/detail/verdict.hpp"
#include "validate/hypothesis/identified.hpp"
#include "validate/hypothesis/search.hpp"
#include "validate/noise/level.hpp"
#include "validate/noise/pre_event.hpp"

namespace swingbank::validate::diagnose {
namespace {

/// Minimum number of hypotheses that are judged on held-out events if none is accepted, and maximum number.
constexpr int kAtLeast = 3, kMostJudged = 9;
/// Number of first effects whose pairs are tried if no hypothesis is accepted alone.
constexpr std::size_t kFirsts = 2;
/// Maximum number of refits of the given model from a better start.
constexpr int kBases = 2;
/// Number of iterations of each fit that continues after a new noise estimate.
constexpr int kOnwards = 4;

class Diagnoser {
 public:
  Diagnoser(const plant::PlantModel& model, std::vector<record::Record> records,
            const DiagnoseOptions& options)
      : model_(model), options_(options) {
    if (records.size() < 2)
      throw InputError({fmt::format("{} event", records.size()), "--records",
                        "an effect is accepted only if it predicts a held-out event",
                        "give records of two events or more"});
    result_.events = noise::whitened_events(model, std::move(records), options.events);
    result_.conventions = model.conventions;
    threads_ = options.threads > 0 ? options.threads : omp_get_max_threads();
  }

  Diagnosis run() {
    const auto begin = std::chrono::steady_clock::now();
    try {
      if (!(fit_all() && judge_all())) interrupt(result_);
    } catch (const Interrupted&) {
      if (!kept_) throw Interrupted{};
      result_ = std::move(*kept_);
      interrupt(result_);
    }
    result_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return std::move(result_);
  }

 private:
  [[nodiscard]] bool stopped() const { return interruption_asked() || (options_.stop && options_.stop()); }
  /// Saves the state for an interruption. All fits of this state have the same noise model.
  void keep() { kept_ = result_; }
  /// Fits the given model, infers the missing inputs and tries every hypothesis. Returns false if the user
  /// has stopped.
  bool fit_all() {
    const noise::WhitenedEvents prepared = result_.events;
    fit::FitOptions from{.lenient = true};
    for (int round = 0;; ++round) {
      report(event::Phase::base, "", 0, 1);
      fit_base(model_, options_, from, result_);
      report(event::Phase::base, "", 1, 1);
      result_.ranked.clear();  // these results belong to a worse base model
      result_.torque = result_.field = {};
      keep();
      report_preliminary(first_sentence(result_, options_.adequate));
      if (stopped()) return false;
      few_wrong();
      if (stopped()) return false;
      infer_inputs();
      keep();
      report_preliminary(side_sentence(result_));
      const hypothesis::BaseModel base_model = present_model();
      result_.ranked = hypothesis::try_hypotheses(base_model, base_model.hypotheses(), options_.progress);
      keep();
      report_preliminary(leading_sentence(result_));
      if (stopped()) return false;
      const auto better = round < kBases ? better_start(base_model, result_) : std::nullopt;
      if (!better) break;
      from = *better;
      result_.events = prepared;  // discards the noise estimated with the worse base model
    }
    try_replacements();
    return !stopped();
  }
  /// Judges the hypotheses and sets the verdict. Returns false if the user has stopped.
  bool judge_all() {
    const bool again = measure_noise_again();
    noise_transfer_.emplace(sim::plant::PlantUnderTest{result_.base.plant, model_.conventions},
                            result_.events, noise::voltage_noise(result_.base.events, result_.events));
    held_out_base_ = hypothesis::hold_out(trial(), model_.under_test(), {}, result_.base);
    if (again) infer_inputs();
    keep();
    for (reduced::FreeInput* m : {&result_.torque, &result_.field}) {
      fit::correct_noise_transfer(&*noise_transfer_, model_.conventions, m->fit);
      m->evidence -= m->fit.transfer_deficit;
    }
    if (stopped()) return false;
    search();
    if (stopped()) return false;
    settle({model_, trial(), result_.base, held_out_base_, result_.torque, result_.field, threads_},
           options_.progress, result_);
    return true;
  }
  /// If the refitted model's residual is noise, searches for a small set of wrong parameters.
  void few_wrong() {
    result_.wrong.reset();
    if (result_.base.reduced_chi2() > options_.adequate) return;
    const auto free = fit::free_parameters(model_.plant, options_.prior_sd);
    fit::SparseOptions o;
    o.progress = options_.progress;
    o.stop = options_.stop;
    o.all = &result_.base;
    o.least = -hypothesis::out_of_reach();
    fit::SparseSelection found = fit::select_parameters(model_.under_test(), result_.events, free, o);
    if (found.wrong.empty() || found.fit.reduced_chi2() > options_.adequate) return;
    result_.wrong_evidence =
        fit::gain(result_.base, found.fit, fit::criterion) - o.each * static_cast<double>(found.wrong.size());
    result_.wrong = std::move(found);
    report_preliminary(wrong_sentence(result_));
  }
  /// If no addition reduces the residual to noise, tries to replace a control by one of another kind.
  void try_replacements() {
    const auto fits = [&](const fit::Fit& f) { return f.reduced_chi2() <= options_.adequate; };
    if (fits(result_.base) || (!result_.ranked.empty() && fits(result_.ranked.front().fit))) return;
    const hypothesis::BaseModel base_model = present_model();
    auto others = hypothesis::try_hypotheses(
        base_model, hypothesis::all_replacements(base_model.under_test(), base_model.library),
        options_.progress);
    std::ranges::move(others, std::back_inserter(result_.ranked));
    std::ranges::stable_sort(result_.ranked, std::greater<>(), &hypothesis::Judgement::gain);
  }
  /// Estimates the noise again from the residuals of the leading hypothesis if the poor fit of the base model
  /// hides the noise. Continues all fits with the new noise. A hypothesis whose fit then fails is dropped,
  /// because its cost refers to the former noise. Returns whether the noise was estimated again.
  bool measure_noise_again() {
    if (result_.ranked.empty() || result_.base.reduced_chi2() < thresholds::noise.measurable) return false;
    const hypothesis::Judgement& best = result_.ranked.front();
    if (!best.fitted || best.fit.reduced_chi2() >= thresholds::noise.measurable) return false;
    result_.events = result_.events.with(
        noise::measure_noise_through({best.fit.plant, best.hypothesis.conventions}, best.fit.events,
                                     best.fit.reduced_chi2(), result_.events));
    const auto go_on = [&](const hypothesis::Hypothesis& h, fit::Fit& f) {
      const auto free = hypothesis::free_of(h, options_.prior_sd);
      f = fit::fit(h.under_test(), result_.events, free,
                   fit::continued({.iterations = kOnwards, .lenient = true}, f, free));
    };
    go_on(hypothesis::unchanged(model_.under_test()), result_.base);
    require_fitted(result_.base, model_);
    each(result_.ranked, event::Phase::noise_again, [&](hypothesis::Judgement& j) {
      if (!j.fitted) return;
      go_on(j.hypothesis, j.fit);
      j.gain = fit::gain(result_.base, j.fit, fit::criterion);
    });
    if (stopped()) throw Interrupted{};  // some fits still have the former noise model
    std::erase_if(result_.ranked, [](const hypothesis::Judgement& j) { return !j.fit.failed.empty(); });
    hypothesis::place_unfitted(result_.ranked);
    std::ranges::stable_sort(result_.ranked, std::greater<>(), &hypothesis::Judgement::gain);
    return true;
  }
  void infer_inputs() {
    const auto free = fit::free_parameters(model_.plant, options_.prior_sd);
    const auto infer = [&](std::size_t i) {
      (i == 0 ? result_.torque : result_.field) =
          reduced::free_input(i == 0 ? fit::InputKind::torque : fit::InputKind::field, model_.under_test(),
                              result_.events, free, result_.base, 1);
    };
    in_parallel(
        2, infer, [&](int done) { report(event::Phase::missing_input, "", done, 2); }, threads_);
  }

  /// Judges the leading hypotheses. Then tries pairs with the companion effect (beside_companion). If no pair
  /// is accepted, tries pairs with the best single hypothesis or, if that is not accepted, with the best two
  /// hypotheses.
  void search() {
    const hypothesis::BaseModel base_model = present_model();
    judge_leading(result_.ranked);
    if (result_.ranked.empty()) return;
    const hypothesis::Judgement best = result_.ranked.front();
    if (stopped() || (!best.accepted && best.gain < thresholds::evidence.accepted)) return;
    auto pairs = beside_companion(base_model);
    if (pairs.empty() || !pairs.front().accepted) {
      std::ranges::move(best.accepted ? judged_beside(base_model, best) : try_pairs(base_model),
                        std::back_inserter(pairs));
      best_first(pairs);
    }
    if (stopped()) return;
    try_alone(pairs);
    const auto unneeded = [&](const hypothesis::Judgement& j) { return !j.accepted || !needed(j); };
    std::erase_if(pairs, unneeded);
    if (!pairs.empty()) {  // the first effect was selected without the second one: try other first effects
      std::vector<hypothesis::Judgement> others = exchanged(base_model, pairs.front());
      std::ranges::move(beside_second(base_model, pairs.front()), std::back_inserter(others));
      std::erase_if(others, unneeded);
      std::ranges::move(others, std::back_inserter(pairs));
      std::ranges::stable_sort(pairs, std::greater<>(), &hypothesis::Judgement::gain);
      cross(base_model, pairs);
    }
    keep_one_order(pairs);
    result_.ranked.insert(result_.ranked.begin(), std::make_move_iterator(pairs.begin()),
                          std::make_move_iterator(pairs.end()));
  }
  [[nodiscard]] hypothesis::BaseModel present_model() const {
    return {.events = result_.events,
            .plant = model_.plant,
            .conventions = model_.conventions,
            .library = model_.library,
            .fit = result_.base,
            .prior_sd = options_.prior_sd,
            .threads = threads_,
            .stop = [this] { return stopped(); },
            .torque = &result_.torque,
            .field = &result_.field};
  }
  /// Tries pairs until one is accepted. Their first effects are the best single hypotheses, one of each slot.
  std::vector<hypothesis::Judgement> try_pairs(const hypothesis::BaseModel& base_model) {
    std::vector<const hypothesis::Judgement*> firsts;
    for (const auto& j : result_.ranked) {
      const bool taken = std::ranges::any_of(firsts, [&](const hypothesis::Judgement* f) {
        return j.hypothesis.slot >= 0 && f->hypothesis.slot == j.hypothesis.slot;
      });
      if (!taken && can_be_first(j) && firsts.size() < kFirsts) firsts.push_back(&j);
    }
    std::vector<hypothesis::Judgement> pairs;
    for (const hypothesis::Judgement* first : firsts) {
      std::ranges::move(judged_beside(base_model, *first), std::back_inserter(pairs));
      best_first(pairs);
      if (!pairs.empty() && pairs.front().accepted) break;
    }
    return pairs;
  }
  /// Returns pairs with the machine or instrument effect that most reduces the cost of a control hypothesis.
  /// The controls were ranked without this effect. Empty if there is no such effect.
  [[nodiscard]] std::vector<hypothesis::Judgement> beside_companion(
      const hypothesis::BaseModel& base_model) const {
    const auto most = std::ranges::max_element(result_.ranked, {}, &hypothesis::Judgement::companion_gain);
    const auto companion = std::ranges::find_if(result_.ranked, [&](const hypothesis::Judgement& j) {
      return j.hypothesis.name == most->companion && j.hypothesis.with.empty();
    });
    if (companion == result_.ranked.end()) return {};
    hypothesis::Judgement first = *companion;
    if (!first.fitted) hypothesis::fit_alone(base_model, first);
    if (!first.fit.failed.empty()) return {};
    return judged_beside(base_model, first);
  }
  [[nodiscard]] bool can_be_first(const hypothesis::Judgement& single) const {
    return single.gain >= trial().evidence && single.fitted && !single.hypothesis.replaces;
  }
  [[nodiscard]] std::vector<hypothesis::Judgement> judged_beside(const hypothesis::BaseModel& base_model,
                                                                 const hypothesis::Judgement& first) const {
    auto pairs = beside(base_model, first);
    judge_leading(pairs);
    return pairs;
  }
  /// Replaces a pair's first effect by its competitors: effects of its slot, and other accepted effects.
  [[nodiscard]] std::vector<hypothesis::Judgement> exchanged(const hypothesis::BaseModel& base_model,
                                                             const hypothesis::Judgement& pair) const {
    auto competitors = hypothesis::exchanges(base_model, pair, result_.ranked);
    each(competitors, event::Phase::pair_exchanges, [&](hypothesis::Judgement& j) {
      hypothesis::try_begun(base_model, j);
      j.gain = fit::gain(result_.base, j.fit, fit::criterion);
    });
    std::erase_if(competitors, [](const hypothesis::Judgement& j) { return !j.fit.failed.empty(); });
    std::ranges::stable_sort(competitors, std::greater<>(), &hypothesis::Judgement::gain);
    std::erase_if(competitors, [&](const hypothesis::Judgement& j) { return out_of_reach(j, pair); });
    each(competitors, event::Phase::pair_unseen_events, [&](hypothesis::Judgement& j) { judge_one(j); });
    return competitors;
  }
  /// Tries the remaining hypotheses with a pair's second effect. The first effect was selected without the
  /// second one and may have compensated for two effects. Empty if the second effect does not satisfy
  /// can_be_first().
  [[nodiscard]] std::vector<hypothesis::Judgement> beside_second(const hypothesis::BaseModel& base_model,
                                                                 const hypothesis::Judgement& pair) const {
    const auto second = std::ranges::find_if(result_.ranked, [&](const hypothesis::Judgement& single) {
      return single.hypothesis.name == pair.hypothesis.name && single.hypothesis.with.empty();
    });
    if (second == result_.ranked.end() || !can_be_first(*second) || stopped()) return {};
    std::vector<std::string> known{pair.hypothesis.with};
    for (const hypothesis::Judgement& j : hypothesis::exchanges(base_model, pair, result_.ranked))
      known.push_back(j.hypothesis.name);
    auto pairs = beside(base_model, *second, known);
    std::erase_if(pairs, [&](const hypothesis::Judgement& j) { return out_of_reach(j, pair); });
    judge_leading(pairs);
    return pairs;
  }
  /// Tries new pairs of the effects of accepted pairs, because each effect was fitted with one partner only.
  /// A pair is tried only if its expected evidence would place it in the credible set.
  void cross(const hypothesis::BaseModel& base_model, std::vector<hypothesis::Judgement>& pairs) const {
    std::vector<hypothesis::Judgement> tried = pairs;
    const auto in_set = [&](double gain) { return gain > pairs.front().gain - hypothesis::out_of_set(); };
    for (auto next = hypothesis::best_cross(tried); next && in_set(next->expected) && !stopped();
         next = hypothesis::best_cross(tried)) {
      hypothesis::Judgement j = hypothesis::crossed(base_model, *next);
      report(event::Phase::pair_crossings, hypothesis::full_name(j.hypothesis), 0, 1);
      hypothesis::try_begun(base_model, j);
      fit::correct_noise_transfer(trial().noise_transfer, j.hypothesis.conventions, j.fit);
      if (j.fit.failed.empty()) j.gain = fit::gain(result_.base, j.fit, fit::criterion);
      tried.push_back(j);
      if (!j.fit.failed.empty() || !in_set(j.gain)) continue;
      judge_one(j);
      if (!j.accepted || !needed(j)) continue;
      pairs.push_back(std::move(j));
      std::ranges::stable_sort(pairs, std::greater<>(), &hypothesis::Judgement::gain);
    }
  }
  static bool out_of_reach(const hypothesis::Judgement& j, const hypothesis::Judgement& pair) {
    return j.gain < pair.gain - thresholds::evidence.within_reach;
  }
  /// Fits every hypothesis except `but` with the effect of `first` present. `gain` is the evidence of both
  /// effects together.
  [[nodiscard]] std::vector<hypothesis::Judgement> beside(const hypothesis::BaseModel& base_model,
                                                          const hypothesis::Judgement& first,
                                                          const std::vector<std::string>& but = {}) const {
    hypothesis::BaseModel then = hypothesis::after(base_model, first);
    then.required = std::min(
        options_.adequate * first.fit.values,
        fit::penalised(first.fit) + first.gain - std::max(result_.torque.evidence, result_.field.evidence));
    auto all = then.hypotheses();
    std::erase_if(all, [&](const hypothesis::Hypothesis& h) { return std::ranges::count(but, h.name) > 0; });
    auto pairs = hypothesis::try_hypotheses(then, std::move(all), options_.progress);
    // A competitor of the best hypothesis in the same slot is kept: its start may have been poor.
    const int slot = pairs.empty() || pairs.front().gain < thresholds::evidence.second
                         ? -1
                         : pairs.front().hypothesis.slot;
    std::erase_if(pairs, [&](const hypothesis::Judgement& j) {
      return !j.fitted || (j.gain < thresholds::evidence.second && (slot < 0 || j.hypothesis.slot != slot));
    });
    for (auto& pair : pairs) pair.gain += first.gain;
    return pairs;
  }
  /// Keeps the better one of the pairs "A with B" and "B with A".
  static void keep_one_order(std::vector<hypothesis::Judgement>& pairs) {
    std::vector<hypothesis::Judgement> kept;
    for (hypothesis::Judgement& j : pairs)
      if (std::ranges::none_of(kept, [&](const hypothesis::Judgement& known) {
            return known.hypothesis.with == j.hypothesis.name && known.hypothesis.name == j.hypothesis.with;
          }))
        kept.push_back(std::move(j));
    pairs = std::move(kept);
  }
  /// Refits each of the best pair's effects alone from the end of the pair's fit. An apparent second effect
  /// may only have provided a better start for the first effect.
  void try_alone(const std::vector<hypothesis::Judgement>& pairs) {
    if (pairs.empty() || !pairs.front().accepted) return;
    const hypothesis::Judgement& pair = pairs.front();
    for (hypothesis::Judgement& single : result_.ranked) {
      const std::string& name = single.hypothesis.name;
      if (!single.fitted || (name != pair.hypothesis.name && name != pair.hypothesis.with)) continue;
      const fit::Fit before = single.fit;
      hypothesis::try_from(present_model(), pair.fit, single);
      if (!(fit::gain(before, single.fit) > 1)) continue;
      single.accepted = false;
      single.why_not.clear();
      judge_one(single);
    }
    best_first(result_.ranked);
  }
  /// Returns whether a pair explains the records clearly better than every accepted single effect.
  [[nodiscard]] bool needed(const hypothesis::Judgement& pair) const {
    return std::ranges::none_of(result_.ranked, [&](const hypothesis::Judgement& single) {
      return single.accepted &&
             (fit::gain(single.fit, pair.fit, fit::data_cost) < thresholds::evidence.second ||
              pair.gain - single.gain < thresholds::evidence.second);
    });
  }
  /// Judges the hypotheses whose evidence is within evidence.within_reach of the best one, and puts accepted
  /// ones first. Judges at least three hypotheses if none is accepted.
  void judge_leading(std::vector<hypothesis::Judgement>& tried) const {
    if (tried.empty()) return;
    const int most = std::min(kMostJudged, static_cast<int>(tried.size()));
    int leading = 0;
    for (double best = tried.front().gain;;) {  // judging may reduce the leading evidence
      const int judged = leading;
      while (leading < most &&
             tried[static_cast<std::size_t>(leading)].gain > best - thresholds::evidence.within_reach)
        ++leading;
      if (leading == judged) break;
      judge_some(tried, judged, leading);
      best = best_gain({tried.begin(), tried.begin() + leading});
    }
    const bool none = std::ranges::none_of(tried, &hypothesis::Judgement::accepted);
    if (none && leading < kAtLeast) judge_some(tried, leading, std::min(kAtLeast, most));
    best_first(tried);
  }
  /// Returns the highest evidence of the accepted hypotheses, or of all judged ones if none is accepted.
  static double best_gain(std::span<const hypothesis::Judgement> judged) {
    const auto better = [](const hypothesis::Judgement& x, const hypothesis::Judgement& y) {
      return x.accepted != y.accepted ? y.accepted : x.gain < y.gain;
    };
    return std::ranges::max_element(judged, better)->gain;
  }
  void judge_some(std::vector<hypothesis::Judgement>& tried, int from, int to) const {
    each(std::span(tried).subspan(static_cast<std::size_t>(from), static_cast<std::size_t>(to - from)),
         tried.front().hypothesis.with.empty() ? event::Phase::unseen_events
                                               : event::Phase::pair_unseen_events,
         [&](hypothesis::Judgement& j) { judge_one(j); });
  }
  /// Judges a hypothesis on held-out events and against the inferred inputs.
  void judge_one(hypothesis::Judgement& j) const {
    hypothesis::judge(trial(), result_.base, held_out_base_, j);
    for (const auto& [m, what] : {std::pair(&result_.torque, "torque"), {&result_.field, "field voltage"}})
      if (j.accepted && m->evidence > j.gain) {
        j.accepted = false;
        j.why_not = fmt::format("an inferred {} explains more", what);
      }
  }
  static void best_first(std::vector<hypothesis::Judgement>& judged) {
    std::ranges::stable_sort(judged, [](const hypothesis::Judgement& x, const hypothesis::Judgement& y) {
      return x.accepted != y.accepted ? x.accepted : x.gain > y.gain;
    });
  }

  /// Applies `act` to each judgement, in parallel.
  template <class F>
  void each(std::span<hypothesis::Judgement> tried, event::Phase phase, F act) const {
    hypothesis::for_each_hypothesis(
        present_model(), options_.progress, phase, tried.size(),
        [&](std::size_t k) { return hypothesis::full_name(tried[k].hypothesis); },
        [&](std::size_t k) { act(tried[k]); });
  }

  [[nodiscard]] hypothesis::Trial trial() const {
    return {result_.events, options_.prior_sd, options_.adequate, thresholds::evidence.accepted,
            noise_transfer_ ? &*noise_transfer_ : nullptr};
  }

  void report_preliminary(const std::string& sentence) const {
    if (options_.preliminary_result) options_.preliminary_result(sentence, result_);
  }
  void report(event::Phase phase, const std::string& item, int done, int total) const {
    if (options_.progress) options_.progress(phase, item, done, total);
  }

  const plant::PlantModel& model_;
  const DiagnoseOptions& options_;
  Diagnosis result_;
  std::optional<Diagnosis> kept_;
  std::vector<hypothesis::HeldOut> held_out_base_;
  std::optional<noise::NoiseTransfer> noise_transfer_;
  int threads_;
};

}  // namespace

Diagnosis diagnose(const plant::PlantModel& model, std::vector<record::Record> records,
                   const DiagnoseOptions& options) {
  return Diagnoser(model, std::move(records), options).run();
}

}  // namespace swingbank::validate::diagnose
