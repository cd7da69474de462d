#include "validate/diagnose.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <span>

#include "validate/decide.hpp"
#include "validate/in_parallel.hpp"
#include "validate/noise.hpp"
#include "validate/search.hpp"

namespace swingbank::validate {
namespace {

/// Rivals within this evidence cannot be told apart.
constexpr double kApart = 25;
/// Evidence that a long fit may add to a short one: what lies further behind the best is not judged.
constexpr double kWorthJudging = 200;
/// How many are judged where none holds.
constexpr int kAtLeast = 3;
/// Evidence and fall of chi2 asked of a second effect: what the first, or the instruments, leave unexplained
/// looks like one (60 in a development case).
constexpr double kSecond = 80;
/// Share of the best one's evidence from which a rival is near it.
constexpr double kNear = 0.2;
/// Leading extensions from which the model alone is fitted once more; what that must gain, of the first one's
/// evidence; and how often it may.
constexpr std::size_t kWaysOut = 2;
constexpr double kEscape = 0.5;
constexpr int kBases = 2;

/// Steps of the fits that go on with the noise measured again.
constexpr int kOnwards = 4;

/// Share of what an effect takes off the unseen events' cost from which one event has all of it; share of
/// that event's error down to which the others have not foretold it.
constexpr double kAlone = 0.8, kForetold = 0.5;

/// What noise leaves may be slow by so many standard deviations (slow_remainder). Thirty development cases
/// with nothing hidden had 3.9 at most.
constexpr double kSlow = 8;

/// Whether the records cannot tell `j` from `best`: by evidence, or by what they leave, for then the simpler
/// one is named by taste.
bool as_good(const Judgement& j, const Judgement& best) {
  return best.gain - j.gain < kApart ||
         (j.hypothesis.with == best.hypothesis.with && j.fit.chi2 - best.fit.chi2 < kApart);
}

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
    result_.conventions = model.conventions;
    threads_ = options.threads > 0 ? options.threads : omp_get_num_procs();
  }

  Diagnosis run() {
    const auto begin = std::chrono::steady_clock::now();
    const std::vector<FitEvent> prepared = result_.events;
    FitOptions from;
    for (int round = 0;; ++round) {
      fit_base(from);
      const Stage stage = model_stage();
      result_.ranked =
          try_hypotheses(stage, all_hypotheses(stage.plant, stage.conventions), options_.progress);
      if (round == kBases || !better_base(from)) break;
      result_.events = prepared;  // the noise was measured beside the worse one
    }
    try_replacements();
    measure_noise_again();
    passed_.emplace(result_.base.plant, model_.conventions, result_.events,
                    voltage_noise(result_.base, result_.events).variance);
    held_out_base_ = hold_out(trial(), model_.plant, model_.conventions, {}, result_.base);
    infer_inputs();
    search();
    settle();
    result_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return std::move(result_);
  }

 private:
  void fit_base(FitOptions o) {
    report("base", 0, 1);
    const auto free = free_parameters(model_.plant, options_.spread);
    result_.base = fit(model_.plant, model_.conventions, result_.events, free, o);
    if (result_.base.failed.empty()) {
      measure_noise_through(result_.base, model_.conventions, result_.events);
      o = continued({}, result_.base, free);
      result_.base = fit(model_.plant, model_.conventions, result_.events, free, o);
    }
    if (!result_.base.failed.empty())
      throw InputError({"the model cannot be fitted", model_.origin, result_.base.failed,
                        "correct the model or leave the record out"});
    report("base", 1, 1);
  }
  /// Whether the model alone fits much better from where its leading extensions ended: then these were ways
  /// out of a poor minimum. `from` gets the better one.
  bool better_base(FitOptions& from) const {
    if (result_.ranked.empty() || result_.ranked.front().gain < kEvidence) return false;
    Judgement base;
    base.hypothesis.plant = model_.plant;
    base.hypothesis.conventions = model_.conventions;
    base.fit = result_.base;
    for (std::size_t k = 0; k < std::min<std::size_t>(kWaysOut, result_.ranked.size()); ++k)
      if (result_.ranked[k].fitted) try_from(model_stage(), result_.ranked[k].fit, base);
    from = continued({}, base.fit, free_parameters(model_.plant, options_.spread));
    return penalised(result_.base) - penalised(base.fit) > kEscape * result_.ranked.front().gain;
  }
  /// Where nothing that could be added leaves only noise, what is there may be of another kind.
  void try_replacements() {
    const auto fits = [&](const Fit& f) { return f.misfit() <= options_.adequate; };
    if (fits(result_.base) || (!result_.ranked.empty() && fits(result_.ranked.front().fit))) return;
    const Stage stage = model_stage();
    auto others = try_hypotheses(stage, all_replacements(stage.plant, stage.conventions), options_.progress);
    std::ranges::move(others, std::back_inserter(result_.ranked));
    std::ranges::stable_sort(result_.ranked, std::greater<>(), &Judgement::gain);
  }
  /// A base that fits badly hides the noise: then it is measured through the leading extension, and all are
  /// fitted on with that.
  void measure_noise_again() {
    if (result_.ranked.empty() || result_.base.misfit() < kClose) return;
    const Judgement& best = result_.ranked.front();
    if (!best.fitted || best.fit.misfit() >= kClose) return;
    measure_noise_through(best.fit, best.hypothesis.conventions, result_.events);
    const auto go_on = [&](const sim::Plant& plant, const sim::Conventions& conventions,
                           const std::vector<FreeParameter>& free, Fit& f) {
      FitOptions o = continued({}, f, free);
      o.iterations = kOnwards;
      if (Fit next = fit(plant, conventions, result_.events, free, o); next.failed.empty()) f = next;
    };
    go_on(model_.plant, model_.conventions, free_parameters(model_.plant, options_.spread), result_.base);
    each(result_.ranked, "noise measured again", [&](Judgement& j) {
      if (!j.fitted) return;
      go_on(j.hypothesis.plant, j.hypothesis.conventions, free_of(j.hypothesis, options_.spread), j.fit);
      j.gain = criterion(result_.base) - criterion(j.fit);
    });
    std::ranges::stable_sort(result_.ranked, std::greater<>(), &Judgement::gain);
  }
  void infer_inputs() {
    FitOptions from;  // parameters bent far out of shape are no start
    if (result_.base.misfit() < kClose)
      from = continued({}, result_.base, free_parameters(model_.plant, options_.spread));
    const auto infer = [&](std::size_t i) {
      MissingInput& m = i == 0 ? result_.torque : result_.field;
      m = infer_input(i == 0 ? InputKind::torque : InputKind::field, model_.plant, model_.conventions,
                      result_.events, options_.spread, from);
    };
    in_parallel(
        2, infer, [&](int done) { report("missing input", done, 2); }, threads_);
  }

  /// Judges the leading hypotheses; then tries each beside the one that holds, or,
  /// where none does, beside the best two.
  void search() {
    const Stage stage = model_stage();
    judge_leading(result_.ranked);
    if (result_.ranked.empty()) return;
    const Judgement best = result_.ranked.front();
    if (!best.accepted && result_.base.misfit() <= options_.adequate) return;
    auto pairs = best.accepted ? judged_beside(stage, best) : try_pairs(stage);
    try_alone(pairs);
    const auto unneeded = [&](const Judgement& j) { return !j.accepted || !needed(j); };
    std::erase_if(pairs, unneeded);
    if (!pairs.empty()) {  // the first was chosen while the second was missing
      auto others = exchanged(stage, pairs.front());
      std::erase_if(others, unneeded);
      std::ranges::move(others, std::back_inserter(pairs));
      std::ranges::stable_sort(pairs, std::greater<>(), &Judgement::gain);
    }
    keep_one_order(pairs);
    result_.ranked.insert(result_.ranked.begin(), std::make_move_iterator(pairs.begin()),
                          std::make_move_iterator(pairs.end()));
  }
  [[nodiscard]] Stage model_stage() const {
    return {.events = result_.events,
            .plant = model_.plant,
            .conventions = model_.conventions,
            .fit = result_.base,
            .spread = options_.spread,
            .threads = threads_};
  }
  /// What the best single hypotheses, one of each slot, leave over for a second one; the next one only where
  /// no pair holds beside the one before.
  std::vector<Judgement> try_pairs(const Stage& stage) {
    std::vector<const Judgement*> firsts;
    for (const auto& j : result_.ranked) {
      const bool taken = std::ranges::any_of(firsts, [&](const Judgement* f) {
        return j.hypothesis.slot >= 0 && f->hypothesis.slot == j.hypothesis.slot;
      });
      if (!taken && j.gain >= trial().evidence && j.fitted && !j.hypothesis.replaces &&
          static_cast<int>(firsts.size()) < options_.firsts)
        firsts.push_back(&j);
    }
    std::vector<Judgement> pairs;
    for (const Judgement* first : firsts) {
      std::ranges::move(judged_beside(stage, *first), std::back_inserter(pairs));
      best_first(pairs);
      if (!pairs.empty() && pairs.front().accepted) break;
    }
    return pairs;
  }
  [[nodiscard]] std::vector<Judgement> judged_beside(const Stage& stage, const Judgement& first) const {
    auto pairs = beside(stage, first);
    judge_leading(pairs);
    return pairs;
  }
  /// Rivals of a pair's first effect in its place: those of its slot, and whatever else holds alone.
  [[nodiscard]] std::vector<Judgement> exchanged(const Stage& stage, const Judgement& pair) const {
    auto rivals = exchanges(stage, pair, result_.ranked);
    each(rivals, "in place of " + pair.hypothesis.with, [&](Judgement& j) {
      try_exchange(stage, pair, j);
      j.gain = criterion(result_.base) - criterion(j.fit);
    });
    std::erase_if(rivals, [](const Judgement& j) { return !j.fit.failed.empty(); });
    std::ranges::stable_sort(rivals, std::greater<>(), &Judgement::gain);
    std::erase_if(rivals, [&](const Judgement& j) { return j.gain < pair.gain - kWorthJudging; });
    each(rivals, "unseen events", [&](Judgement& j) { judge_all(j); });
    return rivals;
  }
  /// Every hypothesis beside one that is taken as given; evidence is that of both.
  [[nodiscard]] std::vector<Judgement> beside(const Stage& stage, const Judgement& first) const {
    const Stage then = after(stage, first);
    auto pairs = try_hypotheses(then, all_hypotheses(then.plant, then.conventions), options_.progress);
    // a rival of the best one may only have started badly
    const int slot = pairs.empty() || pairs.front().gain < kSecond ? -1 : pairs.front().hypothesis.slot;
    std::erase_if(pairs, [&](const Judgement& j) {
      return j.gain < kSecond && (slot < 0 || j.hypothesis.slot != slot || !j.fitted);
    });
    for (auto& pair : pairs) pair.gain += first.gain;
    return pairs;
  }
  /// Of A beside B and B beside A, the better.
  static void keep_one_order(std::vector<Judgement>& pairs) {
    std::vector<Judgement> kept;
    for (Judgement& j : pairs)
      if (std::ranges::none_of(kept, [&](const Judgement& known) {
            return known.hypothesis.with == j.hypothesis.name && known.hypothesis.name == j.hypothesis.with;
          }))
        kept.push_back(std::move(j));
    pairs = std::move(kept);
  }
  /// Each of the best pair's effects alone, from where the pair ended: what looks like a second effect may
  /// only be a better start for the first.
  void try_alone(const std::vector<Judgement>& pairs) {
    if (pairs.empty() || !pairs.front().accepted) return;
    const Judgement& pair = pairs.front();
    for (Judgement& single : result_.ranked) {
      const std::string& name = single.hypothesis.name;
      if (!single.fitted || (name != pair.hypothesis.name && name != pair.hypothesis.with)) continue;
      const double before = penalised(single.fit);
      try_from(model_stage(), pair.fit, single);
      if (!(penalised(single.fit) < before - 1)) continue;
      single.accepted = false;
      single.why_not.clear();
      judge_all(single);
    }
    best_first(result_.ranked);
  }
  /// Whether a pair explains what no single one does: the rival that was not taken may fit as well.
  [[nodiscard]] bool needed(const Judgement& pair) const {
    return std::ranges::none_of(result_.ranked, [&](const Judgement& single) {
      return single.accepted &&
             (single.fit.chi2 - pair.fit.chi2 < kSecond || pair.gain - single.gain < kSecond);
    });
  }
  /// Those that might still be as good as the best, accepted ones first after it; where none of them holds,
  /// three.
  void judge_leading(std::vector<Judgement>& tried) const {
    if (tried.empty()) return;
    give_rivals_a_chance(tried);
    const int most = std::min(options_.leading, static_cast<int>(tried.size()));
    int leading = 0;
    for (double best = tried.front().gain;;) {  // judging may take some of the first ones' evidence away
      const int judged = leading;
      while (leading < most && tried[static_cast<std::size_t>(leading)].gain > best - kWorthJudging)
        ++leading;
      if (leading == judged) break;
      judge_some(tried, judged, leading);
      best = best_gain({tried.begin(), tried.begin() + leading});
    }
    const bool none = std::ranges::none_of(tried, &Judgement::accepted);
    if (none && leading < kAtLeast) judge_some(tried, leading, std::min(kAtLeast, most));
    best_first(tried);
  }
  /// Of those that are accepted; of all where none is.
  static double best_gain(std::span<const Judgement> judged) {
    const auto better = [](const Judgement& x, const Judgement& y) {
      return x.accepted != y.accepted ? y.accepted : x.gain < y.gain;
    };
    return std::ranges::max_element(judged, better)->gain;
  }
  void judge_some(std::vector<Judgement>& tried, int from, int to) const {
    each(std::span(tried).subspan(static_cast<std::size_t>(from), static_cast<std::size_t>(to - from)),
         "unseen events", [&](Judgement& j) { judge_all(j); });
  }
  /// On unseen events, and beside the inputs free in time.
  void judge_all(Judgement& j) const {
    judge(trial(), result_.base, held_out_base_, j);
    for (const auto& [m, what] : {std::pair(&result_.torque, "torque"), {&result_.field, "field voltage"}})
      if (j.accepted && explained(*m) > result_.base.chi2 - j.fit.chi2) {
        j.accepted = false;
        j.why_not = fmt::format("a {} free in time explains more", what);
      }
  }
  static void best_first(std::vector<Judgement>& judged) {
    std::ranges::stable_sort(judged, [](const Judgement& x, const Judgement& y) {
      return x.accepted != y.accepted ? x.accepted : x.gain > y.gain;
    });
  }

  /// Rivals of the best in its slot are fitted from further starts, if they come near it at all.
  void give_rivals_a_chance(std::vector<Judgement>& tried) const {
    const int slot = tried.front().hypothesis.slot;
    if (slot < 0) return;
    const double near = kNear * tried.front().gain;
    const auto rivals = std::stable_partition(tried.begin(), tried.end(), [&](const Judgement& j) {
      return j.hypothesis.slot == slot && j.gain > near && j.fitted;
    });
    const Stage stage = model_stage();
    const Fit leader = std::ranges::max_element(tried.begin(), rivals, {}, &Judgement::gain)->fit;
    each({tried.begin(), rivals}, "further starts", [&](Judgement& j) {
      try_further(stage, leader, j);
      j.gain = criterion(result_.base) - criterion(j.fit);
    });
    std::ranges::stable_sort(tried, std::greater<>(), &Judgement::gain);
  }
  /// Does something with each, on all cores.
  template <class F>
  void each(std::span<Judgement> tried, const std::string& what, F act) const {
    in_parallel(
        tried.size(), [&](std::size_t k) { act(tried[k]); },
        [&](int done, std::size_t k) {
          report(what + " " + full_name(tried[k].hypothesis), done, static_cast<int>(tried.size()));
        },
        threads_);
  }

  [[nodiscard]] Trial trial() const {
    return {result_.events, options_.spread, options_.adequate, kEvidence, passed_ ? &*passed_ : nullptr};
  }

  void settle() {
    const auto& r = result_.ranked;
    const bool quiet = result_.base.misfit() <= options_.adequate &&
                       slow_remainder(result_.base, result_.events) < kSlow &&
                       explained(result_.torque) <= 0 && explained(result_.field) <= 0;
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
  /// What a free input explains of chi2, less what as many free numbers would do of noise, twice (Akaike
  /// 1974).
  [[nodiscard]] double explained(const MissingInput& m) const {
    std::size_t knots = 0;
    for (const auto& e : m.fit.events) knots += e.state.input.t.size();
    return result_.base.chi2 - m.fit.chi2 - 2.0 * static_cast<double>(knots);
  }
  void name_best() {
    const Judgement& best = result_.ranked.front();
    result_.side = best.hypothesis.side;
    if (!best.hypothesis.with.empty()) result_.effects.push_back(best.hypothesis.with);
    result_.effects.push_back(best.hypothesis.name);
    const Judgement* rival = nullptr;
    for (const auto& j : result_.ranked) {
      if (!j.accepted || &j == &best || !as_good(j, best)) continue;
      result_.equivalent.push_back(full_name(j.hypothesis));
      if (!rival) rival = &j;
    }
    result_.verdict = result_.equivalent.empty() ? Verdict::missing : Verdict::confusable;
    std::string rivals;
    for (const auto& name : result_.equivalent) rivals += (rivals.empty() ? "" : ", ") + name;
    result_.sentence = fmt::format(
        "{} {}{}: {}.",
        capitalised(best.hypothesis.with.empty()
                        ? best.hypothesis.what
                        : best.hypothesis.with + ", and besides " + best.hypothesis.what),
        best.hypothesis.replaces ? "explains the records" : "is missing",
        rivals.empty() ? "" : " (or " + rivals + ": these records cannot tell)", fall_of_error(best));
    if (!rival) return;
    result_.would_decide = what_would_decide(best, *rival, result_.events);
    result_.sentence += " " + result_.would_decide;
  }
  /// On unseen events; of what shows in one event only, which no other can predict, there.
  [[nodiscard]] std::string fall_of_error(const Judgement& best) const {
    double saved = 0, before = 0, after = 0;
    for (const auto& h : best.held_out) {
      saved += std::max(0.0, h.saves());
      before += h.before / static_cast<double>(best.held_out.size());
      after += h.after / static_cast<double>(best.held_out.size());
    }
    const auto most = std::ranges::max_element(best.held_out, {}, &HeldOut::saves);
    const auto e = static_cast<std::size_t>(most - best.held_out.begin());
    if (most->saves() > kAlone * saved && most->after > kForetold * most->before)
      return fmt::format(
          "it shows in {} alone, so that no other event foretells it; fitted there too, the error falls from "
          "{:.2f} × noise to {:.2f} × noise",
          most->record, std::sqrt(result_.base.events[e].misfit()), std::sqrt(best.fit.events[e].misfit()));
    return fmt::format(
        "on events it was not fitted to, the error falls from {:.1f} × noise to {:.2f} × noise",
        std::sqrt(before), std::sqrt(after));
  }
  void report(const std::string& what, int done, int total) const {
    if (options_.progress) options_.progress(what, done, total);
  }

  const PlantModel& model_;
  const DiagnoseOptions& options_;
  Diagnosis result_;
  std::vector<HeldOut> held_out_base_;
  std::optional<PassedNoise> passed_;
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
