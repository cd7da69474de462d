#include "validate/add/add.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <map>
#include <sstream>

#include "base/in_parallel.hpp"
#include "base/nearest_word.hpp"
#include "validate/add/detail/joint_fit.hpp"
#include "validate/fit/interrupted.hpp"
#include "validate/fit/sensitivities.hpp"
#include "validate/noise/level.hpp"
#include "validate/noise/pre_event.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::add {
namespace {

hypothesis::RecordContents contents_of(const plant::PlantModel& model,
                                       const std::vector<record::Record>& records) {
  const bool integrated = std::ranges::any_of(
      records, [](const record::Record& r) { return r.angle == record::AngleSource::integrated; });
  return {model.reading.component, integrated};
}

fit::Fit fit_without(const plant::PlantModel& model, const Bench& bench,
                     const std::vector<fit::EventState>& states, double prior_sd) {
  fit::FitOptions o;
  o.start = states;
  return fit::fit(model.under_test(), bench.seen(), fit::free_parameters(model.plant, prior_sd), o);
}

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
      [&](int done) { bench.report_progress(event::Phase::sensitivities, done); });
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
  if (a.own > kInASentence)
    return fmt::format("{} {} values are in the table of parameters", a.effects.size() > 1 ? "Their" : "Its",
                       a.own);
  std::string text;
  for (int i = 0; i < a.own; ++i) {
    const auto& p = a.parameters[static_cast<std::size_t>(i)];
    text += fmt::format("{}{} = {:.4g}{} ({:.4g} to {:.4g})", text.empty() ? "" : ", ", p.name, p.value,
                        p.unit == "-" ? std::string() : " " + std::string(p.unit), p.low, p.high);
  }
  return text;
}

/// Names those of several effects that are not accepted for lack of evidence. Empty if there are none.
std::string without_evidence(const Addition& a) {
  std::string text;
  if (a.effects.size() < 2) return text;
  for (const AddedEffect& e : a.effects)
    if (!(e.evidence > thresholds::addition.strong))
      text += fmt::format(" The evidence of {} beside the others is {:.1f}; {:g} is required.", e.name,
                          e.evidence, thresholds::addition.strong.value);
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
      "{} {}: on {} the reduced chi-square {} from {:.3g} (submitted model) to {:.3g}; the model refitted "
      "without {} has {:.3g}.",
      a.hypothesis.what, a.earns ? "added" : "not accepted", where, after < before ? "falls" : "rises",
      before / n, after / n, a.hypothesis.name, without / n);
  text += without_evidence(a);
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

std::string Addition::name() const {
  std::string all;
  for (const AddedEffect& e : effects) all += (all.empty() ? "" : " + ") + e.name;
  return all;
}

std::vector<std::string> effect_names(const std::vector<std::string>& texts) {
  std::vector<std::string> names;
  for (const std::string& text : texts) {
    std::istringstream parts(text);
    for (std::string name; std::getline(parts >> std::ws, name, '+');) names.push_back(name);
  }
  return names;
}

hypothesis::Hypothesis find_hypothesis(const plant::PlantModel& model, const std::string& name,
                                       const std::vector<record::Record>& records) {
  const hypothesis::RecordContents recorded = contents_of(model, records);
  if (const auto found = named_hypothesis(model.under_test(), model.library, recorded, name)) return *found;
  std::vector<std::string> names;
  for (const auto& h : hypothesis::all_hypotheses(model.under_test(), model.library, recorded))
    names.push_back(h.name);
  const sim::Effect* effect = model.library.find(name);
  const std::string remedy =
      fmt::format("use one of {}, or load a user-defined model with --user-model", fmt::join(names, ", "));
  if (effect == nullptr)
    throw InputError({"effect '" + name + "'", "swingbank add", "there is no effect of that name",
                      suggestion(name, names, remedy)});
  if (effect->switching_times)
    throw InputError({"effect " + std::string(effect->name) + " cannot be added", "swingbank add",
                      "the effect acts at given times and therefore describes one event, not the plant",
                      "write it into the model file by hand"});
  if (effect->angle_lag && !recorded.integrated_angle)
    throw InputError({"effect " + std::string(effect->name) + " cannot be added", "swingbank add",
                      "the effect delays an angle integrated from frequency, and no record has such an angle",
                      "add another effect"});
  const auto reader = sim::reader_of(effect->slot);
  if (reader && std::ranges::none_of(model.plant.controls,
                                     [&](const sim::plant::Block& b) { return b.effect->slot == *reader; }))
    throw InputError({"effect " + std::string(effect->name) + " cannot be added", "swingbank add",
                      fmt::format("only the {} reads the effect's output, and the model has none",
                                  sim::slot_name(*reader)),
                      fmt::format("add the {} first", sim::slot_name(*reader))});
  throw InputError({"effect " + std::string(effect->name) + " cannot be added", "swingbank add",
                    "no free place in slot " + std::string(sim::slot_name(effect->slot)),
                    "write \"" + std::string(effect->name) +
                        " in place of ...\" with the name of the present effect, or " + remedy});
}

namespace {

/// Returns the canonical names of the effects that `texts` name, sorted. Throws InputError with every name
/// that cannot be added, alone or beside the others.
std::vector<std::string> canonical_names(const plant::PlantModel& model,
                                         const std::vector<std::string>& texts,
                                         const std::vector<record::Record>& records) {
  const std::vector<std::string> asked = effect_names(texts);
  plant::PlantModel with = model;
  std::map<std::string, std::string> known;
  for (bool any = true; any;) {
    any = false;
    for (const std::string& name : asked) {
      if (known.contains(name)) continue;
      const auto h = named_hypothesis(with.under_test(), with.library, contents_of(model, records), name);
      if (!h) continue;
      known[name] = h->name;
      with.plant = h->plant;
      with.conventions = h->conventions;
      any = true;
    }
  }
  Problems problems;
  std::vector<std::string> names;
  for (const std::string& name : asked) {
    try {
      names.push_back(known.contains(name) ? known[name] : find_hypothesis(with, name, records).name);
    } catch (const InputError& e) {
      problems.add(e);
    }
  }
  std::ranges::sort(names);
  if (const auto twice = std::ranges::adjacent_find(names); twice != names.end())
    problems.add("effect " + *twice + " is named twice", "swingbank add", "it can be added once",
                 "name it once");
  if (asked.empty())
    problems.add("no effect", "swingbank add", "nothing is named", "name at least one effect");
  problems.raise();
  return names;
}

void work(const plant::PlantModel& model, const std::vector<std::string>& names,
          const std::vector<record::Record>& records, const AddOptions& options, Addition& a) {
  Bench bench(model, records, options.calibrate);
  auto before = bench.each(model.under_test(), event::Phase::model_as_it_is);
  const auto states = bench.states_of(before);
  a.model = model;
  a.without = fit_without(model, bench, states, options.calibrate.prior_sd);
  if (!a.without.failed.empty())
    throw InputError({"the model cannot be fitted", model.origin, a.without.failed, "correct the model"});
  if (JointFit(model, names, contents_of(model, records), bench, options, a).run())
    before = bench.each(model.under_test(), event::Phase::model_as_it_is);
  hypothesis::Hypothesis& hypothesis = a.hypothesis;
  hypothesis.name = a.name();
  hypothesis.with.clear();
  hypothesis.what.clear();
  for (const AddedEffect& e : a.effects) hypothesis.what += (hypothesis.what.empty() ? "" : " and ") + e.what;
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
  a.earns = a.earns && std::ranges::all_of(a.effects, [](const AddedEffect& e) {
              return e.evidence > thresholds::addition.strong;
            });
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

Addition add_effects(const plant::PlantModel& model, const std::vector<std::string>& names,
                     const std::vector<record::Record>& records, const AddOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  Addition a;
  try {
    work(model, canonical_names(model, names, records), records, options, a);
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
    with = bench.go_on(hypothesis::unchanged(model.under_test()), with);
    without = bench.go_on(hypothesis::unchanged(r.model.under_test()), without);
  }
  r.evidence = fit::gain(without, with, fit::criterion);
  if (without.failed.empty()) r.model.plant = without.plant;
  return r;
}

}  // namespace swingbank::validate::add
