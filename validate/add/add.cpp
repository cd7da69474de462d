#include "validate/add/add.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <omp.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <mutex>
#include <optional>

#include "base/in_parallel.hpp"
#include "base/nearest_word.hpp"
#include "validate/fit/interrupted.hpp"
#include "validate/fit/sensitivities.hpp"
#include "validate/hypothesis/search.hpp"
#include "validate/noise/level.hpp"
#include "validate/noise/pre_event.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::add {
namespace {

std::string plain(const std::string& name) {
  std::string out;
  for (const char c : name)
    if (c != ' ' && c != '\t') out += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return out;
}

/// The prepared events, and the subset of seen ones.
class Bench {
 public:
  Bench(const plant::PlantModel& model, std::vector<record::Record> records,
        const calibrate::CalibrateOptions& options)
      : options_(options), out_(calibrate::held_out_events(records, options.held_out)) {
    all_ = noise::whitened_events(model, std::move(records), options.events);
    keep_seen();
  }
  [[nodiscard]] const noise::WhitenedEvents& all() const { return all_; }
  [[nodiscard]] const noise::WhitenedEvents& seen() const { return seen_; }
  /// Measures the noise again through a fit to the seen events, if its reduced chi-square is low enough.
  bool measure_noise(const fit::Fit& seen, const sim::Conventions& conventions) {
    if (seen.reduced_chi2() >= thresholds::noise.measurable) return false;
    const sim::plant::PlantUnderTest fitted{seen.plant, conventions};
    all_ = all_.with(noise::measure_noise_through(fitted, each(fitted, event::Phase::noise_again),
                                                  seen.reduced_chi2(), all_));
    keep_seen();
    return true;
  }
  [[nodiscard]] bool is_seen(std::size_t e) const { return !out_[e]; }

  /// Fits the state of every event by itself, at fixed parameters.
  std::vector<fit::EventFit> each(const sim::plant::PlantUnderTest& tested, event::Phase phase) const {
    std::vector<fit::EventFit> fits(all_.size());
    in_parallel(
        all_.size(),
        [&](std::size_t e) {
          fit::Fit f = fit::fit(tested, all_.alone(e), {});
          if (!f.failed.empty())
            throw InputError({"playback of the record fails", all_[e].record.name, f.failed,
                              "check the model's parameters and the record's base and units"});
          fits[e] = std::move(f.events.front());
        },
        [&](int done) { report_progress(phase, done, static_cast<int>(all_.size())); });
    return fits;
  }
  std::vector<fit::EventState> states_of(const std::vector<fit::EventFit>& fits) const {
    std::vector<fit::EventState> states;
    for (std::size_t e = 0; e < fits.size(); ++e)
      if (!out_[e]) states.push_back(fits[e].state);
    return states;
  }
  void report_progress(event::Phase phase, int done, int total) const {
    if (options_.progress) options_.progress(phase, "", done, total);
  }

 private:
  void keep_seen() {
    std::vector<std::size_t> seen;
    for (std::size_t e = 0; e < all_.size(); ++e)
      if (!out_[e]) seen.push_back(e);
    seen_ = all_.only(seen);
  }

  const calibrate::CalibrateOptions& options_;
  std::vector<bool> out_;
  noise::WhitenedEvents all_, seen_;
};

/// Continues a fit from the end of `f`.
fit::Fit go_on(const sim::plant::PlantUnderTest& tested, const Bench& bench,
               const std::vector<fit::FreeParameter>& free, const fit::Fit& f) {
  return fit::fit(tested, bench.seen(), free, fit::continued({}, f, free));
}

fit::Fit fit_without(const plant::PlantModel& model, const Bench& bench,
                     const std::vector<fit::EventState>& states, double prior_sd) {
  fit::FitOptions o;
  o.start = states;
  return fit::fit(model.under_test(), bench.seen(), fit::free_parameters(model.plant, prior_sd), o);
}

/// The fits without and with the effect.
class Adding {
 public:
  Adding(const plant::PlantModel& model, Bench& bench, const AddOptions& options, Addition& a)
      : bench_(bench),
        progress_(options.calibrate.progress),
        better_(options.reached),
        a_(a),
        base_model_{.events = bench.seen(),
                    .plant = model.plant,
                    .conventions = model.conventions,
                    .library = model.library,
                    .fit = a.without,
                    .prior_sd = options.calibrate.prior_sd,
                    .threads = omp_get_max_threads(),
                    .stop = interruption_asked,
                    .reached = [this](const fit::Fit& f) { keep(f); }} {}

  /// Makes both fits. After an interruption, `with` is the best fit so far. Returns whether the noise was
  /// measured again.
  bool run() {
    a_.with = with_effect();
    hypothesis::Hypothesis none;
    none.plant = base_model_.plant;
    none.conventions = base_model_.conventions;
    a_.without = from_other(none, a_.without, a_.with);
    bool measured = measure_noise();
    while (add_left_off()) measured |= measure_noise();
    return measured;
  }

 private:
  [[nodiscard]] fit::Fit with_effect() {
    hypothesis::Judgement j;
    j.hypothesis = a_.hypothesis;
    j.fitted = false;
    if (auto tried = judgements({a_.hypothesis}); !tried.empty()) j = std::move(tried.front());
    if (!j.fitted) until_interrupted([&] { hypothesis::fit_alone(base_model_, j); });
    if (interruption_asked()) end();
    if (!j.fit.failed.empty())
      throw InputError({"effect " + a_.hypothesis.name + " cannot be fitted", "every start", j.fit.failed,
                        "check the model's parameters, or add another effect"});
    return finished(j);
  }
  /// Frees one group of parameters that the effect's default values leave at null values: the group with the
  /// most evidence. Returns false if no group has the evidence that an effect needs.
  bool add_left_off() {
    auto groups = hypothesis::with_left_off(a_.hypothesis, a_.with.plant);
    if (groups.empty()) return false;
    const auto tried = judgements(std::move(groups));
    if (tried.empty() || !tried.front().fitted) return false;
    fit::Fit with = finished(tried.front());
    a_.with = from_other(a_.hypothesis, a_.with, with);
    with = from_other(tried.front().hypothesis, with, a_.with);
    if (!(fit::gain(a_.with, with, fit::criterion) > thresholds::addition.strong)) return false;
    a_.with = std::move(with);
    const std::string name = a_.hypothesis.name;
    a_.hypothesis = tried.front().hypothesis;
    a_.hypothesis.name = name;
    return true;
  }
  /// Returns the hypotheses in descending order of evidence.
  [[nodiscard]] std::vector<hypothesis::Judgement> judgements(std::vector<hypothesis::Hypothesis> all) {
    std::vector<hypothesis::Judgement> tried;
    until_interrupted([&] { tried = hypothesis::try_hypotheses(base_model_, std::move(all), progress_); });
    if (interruption_asked()) end();
    return tried;
  }
  /// Returns the better of the fit `f` of `h` and a refit of `h` from the end of another structure's fit. The
  /// difference between two local optima of one structure then does not count as evidence.
  [[nodiscard]] fit::Fit from_other(const hypothesis::Hypothesis& h, const fit::Fit& f,
                                    const fit::Fit& other) const {
    hypothesis::Judgement j;
    j.hypothesis = h;
    j.fit = f;
    hypothesis::try_from(base_model_, other, j);
    return fit::better(j.fit, f) ? finished(j) : f;
  }
  /// Returns the fit completed with standard errors: fits of the search have none, or those of lenient steps.
  [[nodiscard]] fit::Fit finished(const hypothesis::Judgement& j) const {
    fit::Fit f = go_on(j.hypothesis.under_test(), bench_,
                       hypothesis::free_of(j.hypothesis, base_model_.prior_sd), j.fit);
    return f.failed.empty() ? f : j.fit;
  }
  /// Measures the noise again through the fit with the effect, if it is close, and repeats both fits.
  bool measure_noise() {
    const hypothesis::Hypothesis& h = a_.hypothesis;
    if (!bench_.measure_noise(a_.with, h.conventions)) return false;
    a_.without = go_on(base_model_.under_test(), bench_,
                       fit::free_parameters(base_model_.plant, base_model_.prior_sd), a_.without);
    a_.with = go_on(h.under_test(), bench_, hypothesis::free_of(h, base_model_.prior_sd), a_.with);
    return true;
  }
  void keep(const fit::Fit& f) {
    const std::lock_guard guard(lock_);
    if (reached_ && !(fit::penalised(f) < fit::penalised(*reached_))) return;
    reached_ = f;
    if (better_) better_(f);
  }
  [[noreturn]] void end() {
    if (a_.with.parameters.empty() && reached_) a_.with = *reached_;
    throw Interrupted{};
  }

  Bench& bench_;
  const event::Progress& progress_;
  const std::function<void(const fit::Fit&)>& better_;
  Addition& a_;
  std::mutex lock_;
  std::optional<fit::Fit> reached_;
  const hypothesis::BaseModel base_model_;
};

/// Returns the increase of each event's limit due to the uncertainty of the fitted parameters; 0 for seen
/// events.
std::vector<double> allowances(const sim::plant::PlantUnderTest& fitted, const Bench& bench,
                               const std::vector<fit::EventFit>& fits,
                               const std::vector<fit::FreeParameter>& free) {
  std::vector<Eigen::MatrixXd> known(fits.size());
  in_parallel(
      fits.size(),
      [&](std::size_t e) {
        known[e] =
            fit::information(fit::event_sensitivities(fitted, bench.all().whitened(e), fits[e].state, free));
      },
      [&](int done) {
        bench.report_progress(event::Phase::sensitivities, done, static_cast<int>(fits.size()));
      });
  const auto n = static_cast<Eigen::Index>(free.size());
  const Eigen::MatrixXd prior = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd all = prior;
  for (std::size_t e = 0; e < known.size(); ++e)
    if (bench.is_seen(e)) all += known[e];
  const Eigen::MatrixXd covariance = all.ldlt().solve(prior);
  std::vector<double> added;
  for (std::size_t e = 0; e < known.size(); ++e)
    added.push_back(
        bench.is_seen(e) ? 0.0 : calibrate::unseen_allowance(known[e], covariance, bench.all()[e].values()));
  return added;
}

/// Corrects the parameters for noise of the played-in voltage and widens the intervals for coloured noise, as
/// calibrate does, with the priors of the hypothesis.
void calibrate_addition(Addition& a, const std::vector<record::Record>& records, const AddOptions& options) {
  plant::PlantModel prior = a.model;
  prior.plant = a.hypothesis.plant;
  calibrate::CalibrateOptions o = options.calibrate;
  o.draws = o.starts = 0;
  o.only_given = true;
  o.given = {{a.hypothesis.name, a.with.plant}};
  o.free = hypothesis::free_of(a.hypothesis, options.calibrate.prior_sd);
  if (options.calibrate.progress)
    o.progress = [&](event::Phase, const std::string& item, int done, int total) {
      options.calibrate.progress(event::Phase::sensitivities, item, done, total);
    };
  const calibrate::Calibration c = calibrate::calibrate(prior, records, o);
  a.parameters.clear();
  for (const auto& p : c.parameters) a.parameters.push_back(p.fit);
  a.model.plant = c.model.plant;
}

/// Returns the effect's values if they are few enough for a sentence; the table of parameters has all.
std::string own_values(const Addition& a) {
  constexpr int kInASentence = 6;
  if (a.own > kInASentence) return fmt::format("Its {} values are in the table of parameters", a.own);
  std::string text;
  for (int i = 0; i < a.own; ++i) {
    const auto& p = a.parameters[static_cast<std::size_t>(i)];
    text += fmt::format("{}{} = {:.4g}{} ({:.4g} to {:.4g})", text.empty() ? "" : ", ", p.name, p.value,
                        p.unit == "-" ? std::string() : " " + std::string(p.unit), p.low, p.high);
  }
  return text;
}

std::string sentence_of(const Addition& a) {
  double before = 0, without = 0, after = 0;
  const bool any_unseen = std::ranges::any_of(a.events, [](const auto& e) { return !e.score.seen; });
  int n = 0;
  for (const auto& e : a.events) {
    if (any_unseen && e.score.seen) continue;
    before += e.score.before;
    without += e.refitted;
    after += e.score.after;
    ++n;
  }
  const std::string where = any_unseen ? "held-out events" : "all events (none held out)";
  std::string text = fmt::format(
      "{} {}: on {} the reduced chi-square {} from {:.3g} (submitted model) to {:.3g}; refitting without {} gives "
      "{:.3g}.",
      a.hypothesis.what, a.earns ? "added" : "not accepted", where, after < before ? "falls" : "rises",
      before / n, after / n, a.hypothesis.name, without / n);
  text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  if (a.own > 0) text += " " + own_values(a) + ".";
  std::string residual = a.adequate ? calibrate::residual_text(a.scores())
                                    : "the residual exceeds noise: another component is missing";
  residual.front() = 'T';
  text += " " + residual + ".";
  if (const std::string bounds = fit::bounds_text(a.parameters); !bounds.empty()) text += " " + bounds;
  return text;
}

}  // namespace

std::vector<calibrate::EventScore> Addition::scores() const {
  std::vector<calibrate::EventScore> all;
  for (const auto& e : events) all.push_back(e.score);
  return all;
}

hypothesis::Hypothesis find_hypothesis(const plant::PlantModel& model, const std::string& name) {
  const auto named = [&](const hypothesis::Hypothesis& h) { return plain(h.name) == plain(name); };
  auto all = hypothesis::all_hypotheses(model.under_test(), model.library, {model.reading.component, true});
  std::vector<std::string> names;
  for (const auto& h : all) names.push_back(h.name);
  std::ranges::move(hypothesis::all_replacements(model.under_test(), model.library), std::back_inserter(all));
  if (const auto found = std::ranges::find_if(all, named); found != all.end()) return *found;
  const sim::Effect* effect = model.library.find(name);
  const std::string remedy =
      fmt::format("use one of {}, or load a user-defined model with --law", fmt::join(names, ", "));
  if (effect == nullptr)
    throw InputError({"effect '" + name + "'", "swingbank add", "there is no effect of that name",
                      suggestion(name, names, remedy)});
  if (effect->switching_times)
    throw InputError({"effect " + std::string(effect->name), "swingbank add",
                      "it acts at given times and so belongs to one event, not to the plant",
                      "write it into the model file by hand"});
  const auto reader = sim::reader_of(effect->slot);
  if (reader && std::ranges::none_of(model.plant.controls,
                                     [&](const sim::plant::Block& b) { return b.effect->slot == *reader; }))
    throw InputError(
        {"effect " + std::string(effect->name), "swingbank add",
         fmt::format("its output acts through the {}, and the model has none", sim::slot_name(*reader)),
         fmt::format("add the {} first", sim::slot_name(*reader))});
  throw InputError({"effect " + std::string(effect->name), "swingbank add",
                    "no free place in slot " + std::string(sim::slot_name(effect->slot)),
                    "write \"" + std::string(effect->name) +
                        " in place of ...\" with the name of the present effect, or " + remedy});
}

namespace {

void work(const plant::PlantModel& model, const std::vector<record::Record>& records,
          const AddOptions& options, Addition& a) {
  Bench bench(model, records, options.calibrate);
  auto before = bench.each(model.under_test(), event::Phase::model_as_it_is);
  const auto states = bench.states_of(before);
  hypothesis::Hypothesis& hypothesis = a.hypothesis;
  a.model = model;
  a.without = fit_without(model, bench, states, options.calibrate.prior_sd);
  if (!a.without.failed.empty())
    throw InputError({"the model cannot be fitted", model.origin, a.without.failed, "correct the model"});
  if (Adding(model, bench, options, a).run())
    before = bench.each(model.under_test(), event::Phase::model_as_it_is);
  a.own = static_cast<int>(hypothesis.free.size());
  a.evidence = fit::gain(a.without, a.with, fit::criterion);
  const auto refitted = bench.each({a.without.plant, model.conventions}, event::Phase::effect_left_out);
  const auto after = bench.each({a.with.plant, hypothesis.conventions}, event::Phase::effect_added);
  const auto allowed = allowances({a.with.plant, hypothesis.conventions}, bench, after,
                                  hypothesis::free_of(hypothesis, options.calibrate.prior_sd));
  a.earns = true;
  for (std::size_t e = 0; e < bench.all().size(); ++e) {
    AddedEvent event{
        calibrate::score_event(bench.all().whitened(e), before[e], after[e], bench.is_seen(e),
                               calibrate::pre_event_samples(bench.all()), options.calibrate.adequate),
        refitted[e].reduced_chi2()};
    event.score.allowance = allowed[e];
    event.score.limit += allowed[e];
    a.earns = a.earns && (event.score.seen || event.improves() || event.score.adequate());
    a.events.push_back(std::move(event));
  }
  a.ruling = thresholds::judged_by_events(a.scores());
  a.adequate = a.ruling.adequate;
  a.earns = a.earns && a.evidence > thresholds::addition.strong;
  a.model.plant = a.with.plant;
  a.model.conventions = hypothesis.conventions;
  a.parameters = a.with.parameters;
  if (a.adequate) calibrate_addition(a, records, options);
  // A fit lists the effect's parameters last.
  std::rotate(a.parameters.begin(), a.parameters.end() - a.own, a.parameters.end());
  a.prepared = bench.all();
  a.sentence = sentence_of(a);
}

}  // namespace

Addition add_effect(const plant::PlantModel& model, const hypothesis::Hypothesis& asked,
                    const std::vector<record::Record>& records, const AddOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  Addition a;
  a.hypothesis = asked;
  try {
    work(model, records, options, a);
  } catch (const Interrupted&) {
    if (a.with.parameters.empty()) throw Interrupted{};
    throw fit::InterruptedFit{{}, a.with};
  }
  a.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return a;
}

Removal try_without(const plant::PlantModel& model, std::size_t control, std::vector<record::Record> records,
                    const AddOptions& options) {
  Bench bench(model, std::move(records), options.calibrate);
  Removal r;
  r.effect = model.plant.controls[control].effect->name;
  r.model = model;
  r.model.plant.controls.erase(r.model.plant.controls.begin() + static_cast<std::ptrdiff_t>(control));
  const auto states = bench.states_of(bench.each(model.under_test(), event::Phase::effect_added));
  const double prior_sd = options.calibrate.prior_sd;
  fit::Fit with = fit_without(model, bench, states, prior_sd),
           without = fit_without(r.model, bench, states, prior_sd);
  if (with.failed.empty() && without.failed.empty() && bench.measure_noise(with, model.conventions)) {
    with = go_on(model.under_test(), bench, fit::free_parameters(model.plant, prior_sd), with);
    without = go_on({r.model.plant, model.conventions}, bench, fit::free_parameters(r.model.plant, prior_sd),
                    without);
  }
  r.evidence = fit::gain(without, with, fit::criterion);
  if (without.failed.empty()) r.model.plant = without.plant;
  return r;
}

}  // namespace swingbank::validate::add
