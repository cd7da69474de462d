#include "validate/diagnose/detail/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "validate/fit/noise.hpp"
#include "validate/hypothesis/distinguish.hpp"

namespace swingbank::validate::diagnose {
namespace {

/// Whether the records cannot tell `j` from `best`. They cannot if their evidences are close. Nor can they if
/// both leave about the same chi2, because the evidence then only prefers the simpler one.
bool as_good(const hypothesis::Judgement& j, const hypothesis::Judgement& best) {
  return best.gain - j.gain < thresholds::evidence.apart ||
         (j.hypothesis.with == best.hypothesis.with &&
          fit::gain(j.fit, best.fit, fit::data_cost) < thresholds::evidence.apart);
}

std::string capitalised(std::string text) {
  if (!text.empty()) text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  return text;
}

/// Says how far the error falls on unseen events. No other event can predict an effect that shows in one
/// event only; its error is then that of the fit to this event.
std::string fall_of_error(const fit::Fit& base, const hypothesis::Judgement& best) {
  double saved = 0, before = 0, after = 0;
  for (const auto& h : best.held_out) {
    saved += std::max(0.0, h.saves());
    before += h.before / static_cast<double>(best.held_out.size());
    after += h.after / static_cast<double>(best.held_out.size());
  }
  const auto most = std::ranges::max_element(best.held_out, {}, &hypothesis::HeldOut::saves);
  const auto e = static_cast<std::size_t>(most - best.held_out.begin());
  if (most->saves() > thresholds::held_out.alone * saved &&
      most->after > thresholds::held_out.foretold * most->before)
    return fmt::format(
        "it shows in {} alone, so that no other event foretells it; fitted there too, the error falls from "
        "{:.2f} × noise to {:.2f} × noise",
        most->record, std::sqrt(base.events[e].misfit()), std::sqrt(best.fit.events[e].misfit()));
  return fmt::format("on events it was not fitted to, the error falls from {:.1f} × noise to {:.2f} × noise",
                     std::sqrt(before), std::sqrt(after));
}

void name_best(Diagnosis& d) {
  const hypothesis::Judgement& best = d.ranked.front();
  d.ruling = thresholds::judged_by_evidence(hypothesis::full_name(best.hypothesis), best.gain);
  d.side = best.hypothesis.side;
  if (!best.hypothesis.with.empty()) d.effects.push_back(best.hypothesis.with);
  d.effects.push_back(best.hypothesis.name);
  const hypothesis::Judgement* rival = nullptr;
  for (const auto& j : d.ranked) {
    if (!j.accepted || &j == &best || !as_good(j, best)) continue;
    d.equivalent.push_back(hypothesis::full_name(j.hypothesis));
    if (!rival) rival = &j;
  }
  d.verdict = d.equivalent.empty() ? Verdict::missing : Verdict::confusable;
  std::string rivals;
  for (const auto& name : d.equivalent) rivals += (rivals.empty() ? "" : ", ") + name;
  d.sentence = fmt::format("{} {}{}: {}.",
                           capitalised(best.hypothesis.with.empty()
                                           ? best.hypothesis.what
                                           : best.hypothesis.with + ", and besides " + best.hypothesis.what),
                           best.hypothesis.replaces ? "explains the records" : "is missing",
                           rivals.empty() ? "" : " (or " + rivals + ": these records cannot tell)",
                           fall_of_error(d.base, best));
  if (!rival) return;
  d.would_decide = hypothesis::what_would_decide(best, *rival, d.events);
  d.sentence += " " + d.would_decide;
}

}  // namespace

std::string first_sentence(const Diagnosis& d, double adequate) {
  const double slow = slow_remainder(d.base, d.events);
  if (d.base.misfit() <= adequate && slow <= thresholds::adequacy.slow)
    return fmt::format(
        "So far: with its parameters refitted the model leaves nothing but noise (chi2 per value {:.3f}).",
        d.base.misfit());
  return fmt::format(
      "So far: something is missing; with its parameters refitted the model leaves chi2 of {:.2f} per value, "
      "slow means {:.1f} standard deviations.",
      d.base.misfit(), slow);
}

std::string side_sentence(const Diagnosis& d) {
  const double t = d.torque.misfit(), f = d.field.misfit();
  const bool explains =
      std::max(d.torque.explains(d.base), d.field.explains(d.base)) > thresholds::adequacy.free_input;
  const bool both = std::max(t, f) <= thresholds::laws.as_much * std::min(t, f);
  return fmt::format(
      "So far: {} (chi2 per value {:.2f} with a torque free in time, {:.2f} with a field voltage free in "
      "time).",
      !explains ? "neither a torque nor a field voltage explains what is left"
      : both    ? "a torque and a field voltage explain what is left about as well"
      : t < f   ? "it looks like the mechanical side"
                : "it looks like the excitation side",
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
  return names.empty() ? "So far: no effect of the list explains anything."
                       : "So far, not yet judged on unseen events: " + names + ".";
}

std::string_view verdict_name(Verdict verdict) {
  constexpr std::array<std::string_view, 4> names = {"adequate", "missing", "confusable", "unexplained"};
  return names[static_cast<std::size_t>(verdict)];
}

void settle(const laws::Unexplained& judged, const laws::LawProgress& progress, Diagnosis& d) {
  const auto& r = d.ranked;
  if (!r.empty() && r.front().accepted) return name_best(d);
  d.ruling = thresholds::judged_by_remainder({d.base.misfit(), slow_remainder(d.base, d.events),
                                              d.torque.explains(d.base), d.field.explains(d.base)},
                                             judged.trial.adequate);
  if (d.ruling.adequate) {
    d.verdict = Verdict::adequate;
    d.sentence = fmt::format(
        "The model is adequate: after refitting its parameters nothing but noise is left (chi2 per value "
        "{:.3f}), and no effect in the list improves it.",
        d.base.misfit());
    return;
  }
  d.verdict = Verdict::unexplained;
  const double t = d.torque.misfit(), f = d.field.misfit();
  d.side = t < f ? hypothesis::Side::mechanical : hypothesis::Side::excitation;
  d.sentence = fmt::format(
      "None of the {} known effects explains the records (chi2 per value {:.2f} at best {:.2f}). A missing "
      "{} would (chi2 per value {:.2f}); its course is shown.",
      r.size(), d.base.misfit(), r.empty() ? d.base.misfit() : r.front().fit.misfit(),
      t < f ? "torque" : "field voltage", std::min(t, f));
  d.laws = laws::search_laws(judged, progress);
  if (d.laws.found()) {
    d.side = d.laws.found()->judgement.hypothesis.side;
    d.sentence = laws::law_sentence(d.laws, r.size());
  }
}

}  // namespace swingbank::validate::diagnose
