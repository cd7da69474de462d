#include "validate/diagnose/detail/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <span>

#include "validate/hypothesis/decide.hpp"
#include "validate/noise/level.hpp"
#include "validate/noise/lines.hpp"
#include "validate/report/figures.hpp"

namespace swingbank::validate::diagnose {
namespace {

constexpr std::size_t kPairsInSentence = 3;  ///< maximum number of pairs in the sentence; the table shows all

/// Returns the evidence at which an explanation with these effects is as probable as the model without them.
double price(const hypothesis::Hypothesis& h) {
  return thresholds::evidence.accepted + (h.with.empty() ? 0.0 : thresholds::evidence.second.value);
}
/// Returns for example "GENROU.H, SEXS.K".
std::string wrong_names(const Diagnosis& d) {
  std::string names;
  for (const auto& w : d.wrong->wrong) names += (names.empty() ? "" : ", ") + w.fit.full_name();
  return names;
}
/// Computes the probabilities of the explanations: the given model, the given model with a few wrong
/// parameters, every accepted effect, every fitted effect whose evidence is below the threshold of
/// acceptance, and none of these.
void weigh(Diagnosis& d) {
  std::vector<hypothesis::Explanation> all = {{hypothesis::kNothingMissing}};
  if (d.wrong)
    all.push_back(
        {fmt::format("{}, but wrong: {}", hypothesis::kNothingMissing, wrong_names(d)), d.wrong_evidence});
  for (std::size_t k = 0; k < d.ranked.size(); ++k)
    if (const hypothesis::Judgement& j = d.ranked[k];
        j.accepted || (j.fitted && j.fit.failed.empty() && j.gain < thresholds::evidence.accepted.value))
      all.push_back({hypothesis::full_name(j.hypothesis), j.gain - price(j.hypothesis), static_cast<int>(k)});
  const auto worth = [](const reduced::FreeInput& m) { return m.evidence - thresholds::evidence.accepted; };
  const double line = noise::strongest_line(d.base.events, d.events).explains - thresholds::adequacy.line;
  d.probabilities = hypothesis::posterior(std::move(all), std::max({worth(d.torque), worth(d.field), line}));
}

/// Returns the measures of the refitted model's residual. `torque` and `field`: evidence of the inferred
/// inputs; 0 if not yet known.
thresholds::Refitted left_by(const Diagnosis& d, double torque, double field) {
  return {d.base.reduced_chi2(), noise::slow_remainder(d.base.events, d.events),
          noise::strongest_line(d.base.events, d.events).explains, torque, field};
}
/// Returns " The residual oscillates at 0.37 Hz in P ..." if this oscillation is the criterion that decides
/// that the residual exceeds noise. Otherwise returns an empty text, because every residual has a strongest
/// frequency.
std::string line_sentence(const Diagnosis& d) {
  if (thresholds::judged_by_remainder(left_by(d, 0, 0), thresholds::adequacy.reduced_chi2).by !=
      thresholds::Criterion::line)
    return "";
  const noise::Line line = noise::strongest_line(d.base.events, d.events);
  return fmt::format(" The residual oscillates at {:.2f} Hz in {} (chi2 {:.0f}, all events).", line.frequency,
                     playin::output_name(line.channel), line.explains);
}

std::string capitalised(std::string text) {
  if (!text.empty()) text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  return text;
}

/// Describes the decrease of the error on held-out events. If an effect acts in one event only, no other
/// event can predict it; the errors are then those of the fit that includes this event.
std::string fall_of_error(const fit::Fit& base, const hypothesis::Judgement& best) {
  double saved = 0;
  for (const auto& h : best.held_out) saved += std::max(0.0, h.saves());
  const auto most = std::ranges::max_element(best.held_out, {}, &hypothesis::HeldOut::saves);
  const auto e = static_cast<std::size_t>(most - best.held_out.begin());
  if (most->saves() > thresholds::held_out.alone * saved &&
      most->after > thresholds::held_out.unpredicted * most->before)
    return fmt::format(
        "it acts in {} alone, so no other event predicts it; with this event in the fit, its "
        "normalised RMS falls from {:.2f} to {:.2f}",
        most->record, std::sqrt(base.events[e].reduced_chi2()), std::sqrt(best.fit.events[e].reduced_chi2()));
  const auto [before, after] = hypothesis::mean_reduced_chi2(best.held_out);
  return fmt::format("on held-out events the normalised RMS falls from {:.1f} to {:.2f}", std::sqrt(before),
                     std::sqrt(after));
}

double probability_of_nothing_missing(const Diagnosis& d) {
  double sum = 0;
  for (const auto& e : d.probabilities)
    if (e.name.starts_with(hypothesis::kNothingMissing)) sum += e.probability;
  return sum;
}

/// Returns the sentence that nothing is missing, with the wrong parameters if they are few.
std::string adequate_sentence(const Diagnosis& d) {
  const std::string probable = report::probability_text(probability_of_nothing_missing(d));
  if (d.wrong)
    return fmt::format(
        "No component is missing ({}), but {} parameter {} wrong: {}. With {} changed the "
        "residual is noise (reduced chi-square {:.3f}), and no listed effect improves the fit.",
        probable, d.wrong->wrong.size(), d.wrong->wrong.size() == 1 ? "value is" : "values are",
        wrong_names(d), d.wrong->wrong.size() == 1 ? "it" : "them", d.wrong->fit.reduced_chi2());
  return fmt::format(
      "The model is adequate ({}): with refitted parameters the residual is noise (reduced "
      "chi-square {:.3f}), and no listed effect improves the fit.",
      probable, d.base.reduced_chi2());
}

/// Returns for example "SEXS (62 %), EXST1 (21 %)".
std::string with_probabilities(std::span<const hypothesis::Explanation> some) {
  std::string text;
  for (const auto& e : some)
    text +=
        fmt::format("{}{} ({})", text.empty() ? "" : ", ", e.name, report::probability_text(e.probability));
  return text;
}
/// Returns the text of with_probabilities() for a set. Of a set with many pairs, it lists only the first
/// ones.
std::string set_text(std::span<const hypothesis::Explanation> set, bool pairs) {
  if (!pairs || set.size() <= kPairsInSentence) return with_probabilities(set);
  return fmt::format("{} and {} more", with_probabilities(set.first(kPairsInSentence)),
                     set.size() - kPairsInSentence);
}

/// Returns the explanations of the credible set.
std::span<const hypothesis::Explanation> credible_set(const Diagnosis& d) {
  return std::span(d.probabilities).first(hypothesis::credible(d.probabilities));
}

/// Returns for example "Probability of each effect: IEEET1 (62 %), IEEEG1 (44 %).". Each probability is the
/// sum over all explanations with the effect.
std::string by_effect_sentence(const Diagnosis& d) {
  std::vector<hypothesis::Explanation> alone;
  const auto count = [&](const std::string& name, double probability) {
    const auto known = std::ranges::find(alone, name, &hypothesis::Explanation::name);
    if (known == alone.end())
      alone.push_back({.name = name, .probability = probability});
    else
      known->probability += probability;
  };
  for (const auto& e : d.probabilities) {
    if (e.place < 0) continue;
    const hypothesis::Hypothesis& h = d.ranked[static_cast<std::size_t>(e.place)].hypothesis;
    if (!h.with.empty()) count(h.with, e.probability);
    count(h.name, e.probability);
  }
  std::erase_if(alone, [](const auto& e) { return e.probability < kShownFrom; });
  std::ranges::stable_sort(alone, std::greater<>(), &hypothesis::Explanation::probability);
  return "Probability of each effect: " + with_probabilities(alone) + ".";
}

bool names_an_effect(const Diagnosis& d) {
  return std::ranges::any_of(credible_set(d), [](const auto& e) { return e.place >= 0; });
}

/// Withdraws all acceptances, because other explanations form the credible set.
void refuse_all(Diagnosis& d) {
  for (hypothesis::Judgement& j : d.ranked) {
    if (!j.accepted) continue;
    j.accepted = false;
    j.why_not = fmt::format("much less probable than: {}", d.probabilities.front().name);
  }
}

void name_best(const user_model_search::Unexplained& judged, Diagnosis& d) {
  const auto set = credible_set(d);
  const auto first = std::ranges::find_if(set, [](const auto& e) { return e.place >= 0; });
  const hypothesis::Judgement& best = d.ranked[static_cast<std::size_t>(first->place)];
  d.ruling = thresholds::judged_by_evidence(hypothesis::full_name(best.hypothesis), best.gain);
  d.side = best.hypothesis.side;
  if (!best.hypothesis.with.empty()) d.effects.push_back(best.hypothesis.with);
  d.effects.push_back(best.hypothesis.name);
  std::vector<hypothesis::Explanation> others;
  for (const auto& e : set) {
    if (&e == &*first) continue;
    others.push_back(e);
    if (e.place >= 0) d.equivalent.push_back(e.name);
  }
  d.verdict = d.equivalent.empty() ? Verdict::missing : Verdict::confusable;
  const bool pairs = !best.hypothesis.with.empty();
  const std::string does = best.hypothesis.replaces ? "explains the records" : "is missing";
  if (first->probability > thresholds::posterior.named)
    d.sentence =
        fmt::format("{} {} ({}){}",
                    capitalised(best.hypothesis.with.empty()
                                    ? best.hypothesis.what
                                    : best.hypothesis.with + ", together with " + best.hypothesis.what),
                    does, report::probability_text(first->probability),
                    others.empty() ? "" : ", or " + set_text(others, pairs));
  else
    d.sentence = fmt::format("Undecided: one of these effects {}: {}", does, set_text(set, pairs));
  d.sentence += fmt::format(": {}.", fall_of_error(d.base, best));
  if (set.size() > 1 && pairs) d.sentence += " " + by_effect_sentence(d);
  d.would_decide = hypothesis::what_would_decide(d.ranked, d.probabilities, judged.trial.events,
                                                 judged.trial.prior_sd, judged.threads);
  if (const std::string words = hypothesis::decide_sentence(d.would_decide); !words.empty())
    d.sentence += " " + words;
}

}  // namespace

std::string tempering_note() {
  return fmt::format(
      "Tempered probability p ∝ exp(Δ/(2 · {0:g})). Δ: 2 ln(Bayes factor) minus the evidence required of each "
      "effect. The divisor {0:g} allows for incomplete fits and an incomplete noise model (decision 41).",
      thresholds::posterior.scale.value);
}

std::string first_sentence(const Diagnosis& d, double adequate) {
  const double slow = noise::slow_remainder(d.base.events, d.events);
  if (thresholds::judged_by_remainder(left_by(d, 0, 0), adequate).adequate)
    return fmt::format(
        "Preliminary: with refitted parameters the residual is noise (reduced chi-square {:.3f}).",
        d.base.reduced_chi2());
  return fmt::format(
      "Preliminary: the model is incomplete. Reduced chi-square after the first refit: {:.2f} (noise: 1). Power of "
      "the residual's means over 0.5 to 2 s: {:.3g} standard deviations above white noise.{}",
      d.base.reduced_chi2(), slow, line_sentence(d));
}

std::string wrong_sentence(const Diagnosis& d) {
  return "Preliminary: " + calibrate::wrong_sentence(*d.wrong, thresholds::adequacy.reduced_chi2);
}

std::optional<calibrate::WrongParameters> wrong_parameters(const Diagnosis& d) {
  if (!d.wrong) return std::nullopt;
  return calibrate::WrongParameters{*d.wrong,
                                    {},
                                    thresholds::adequacy.reduced_chi2,
                                    calibrate::wrong_sentence(*d.wrong, thresholds::adequacy.reduced_chi2)};
}

std::string side_sentence(const Diagnosis& d) {
  const double t = d.torque.reduced_chi2(), f = d.field.reduced_chi2();
  const bool explains = std::max(d.torque.evidence, d.field.evidence) > thresholds::evidence.accepted;
  const bool both = std::max(t, f) <= thresholds::user_models.as_much * std::min(t, f);
  return fmt::format(
      "Preliminary: {}. Reduced chi-square with an unknown mechanical torque: {:.2f}; with an unknown field voltage: "
      "{:.2f}.",
      !explains ? "neither mechanical torque nor field voltage explains the residual"
      : both    ? "mechanical torque and field voltage explain the residual about equally well"
      : t < f   ? "mechanical torque explains more of the residual"
                : "field voltage explains more of the residual",
      t, f);
}

std::string leading_sentence(const Diagnosis& d) {
  std::string names;
  std::size_t named = 0;
  for (const auto& j : d.ranked)
    if (j.fitted && j.gain > thresholds::evidence.accepted && named < 3) {
      names += fmt::format("{}{} (evidence {:.0f})", names.empty() ? "" : ", ",
                           hypothesis::full_name(j.hypothesis), j.gain);
      ++named;
    }
  return names.empty() ? "Preliminary: no listed effect improves the fit."
                       : "Preliminary, not yet tested on held-out events: " + names + ".";
}

std::string_view verdict_name(Verdict verdict) {
  constexpr std::array<std::string_view, 5> names = {"adequate", "missing", "confusable", "unexplained",
                                                     "interrupted"};
  return names[static_cast<std::size_t>(verdict)];
}

void interrupt(Diagnosis& d) {
  d.verdict = Verdict::interrupted;
  d.ruling = thresholds::judged_by_remainder(left_by(d, 0, 0), thresholds::adequacy.reduced_chi2);
  for (hypothesis::Judgement& j : d.ranked) {
    j.accepted = false;
    if (j.why_not.empty()) j.why_not = "not judged: interrupted";
  }
  std::string leading;
  for (const auto& j : d.ranked)
    if (j.fitted && j.fit.failed.empty() && j.gain > thresholds::evidence.accepted && leading.empty())
      leading = fmt::format("{} had the highest evidence ({:.0f}), but was not judged on held-out events",
                            hypothesis::full_name(j.hypothesis), j.gain);
  d.sentence = fmt::format(
      "Interrupted before a verdict. With refitted parameters the reduced chi-square is {:.2f}; {}.",
      d.base.reduced_chi2(), leading.empty() ? "no effect had improved the fit yet" : leading);
}

void settle(const user_model_search::Unexplained& judged, const event::Progress& progress, Diagnosis& d) {
  const auto& r = d.ranked;
  weigh(d);
  if (!r.empty() && r.front().accepted && names_an_effect(d)) return name_best(judged, d);
  refuse_all(d);
  d.ruling =
      thresholds::judged_by_remainder(left_by(d, d.torque.evidence, d.field.evidence), judged.trial.adequate);
  if (d.ruling.adequate) {
    d.verdict = Verdict::adequate;
    d.sentence = adequate_sentence(d);
    return;
  }
  d.verdict = Verdict::unexplained;
  const double t = d.torque.reduced_chi2(), f = d.field.reduced_chi2();
  d.side = t < f ? hypothesis::Side::mechanical : hypothesis::Side::excitation;
  d.sentence = fmt::format(
      "None of the {} known effects explains the records (reduced chi-square {:.2f} without, at best "
      "{:.2f} with an effect). With an inferred {} it is {:.2f}; the report shows the inferred time series.{}",
      r.size(), d.base.reduced_chi2(), r.empty() ? d.base.reduced_chi2() : r.front().fit.reduced_chi2(),
      t < f ? "torque" : "field voltage", std::min(t, f), line_sentence(d));
  d.user_models = user_model_search::search_user_models(judged, progress);
  if (d.user_models.found()) {
    d.side = d.user_models.found()->judgement.hypothesis.side;
    d.sentence = user_model_search::user_model_sentence(d.user_models, r.size());
  }
}

}  // namespace swingbank::validate::diagnose
