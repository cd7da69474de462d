#include "validate/add/report.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>

#include "validate/calibrate/report.hpp"
#include "validate/diagnose/report.hpp"
#include "validate/thresholds/list.hpp"

namespace swingbank::validate::add {
namespace {

using nlohmann::json;

std::string verb(const Addition& a) {
  return fmt::format("{} {}", a.effects.size() > 1 ? "are" : "is", a.earns ? "accepted" : "not accepted");
}

/// Returns the criterion of this command for the effect, with the criterion of `diagnose` for comparison.
std::string judged_by(const Addition& a) {
  const bool any_unseen = std::ranges::any_of(a.events, [](const auto& e) { return !e.score.seen; });
  return fmt::format(
      "{} {}. Criterion: evidence of each effect above {:g}{}. `diagnose` compares many effects. It requires evidence above "
      "{:g}, prediction of every held-out event, and more evidence than any inferred input.",
      a.hypothesis.name, verb(a), thresholds::addition.strong.value,
      any_unseen ? ", and no held-out event fits worse, except within noise"
                 : " (there is no held-out event)",
      thresholds::evidence.accepted.value);
}

/// Returns the evidence of each of several effects; empty for a single effect.
std::string evidence_beside(const Addition& a) {
  if (a.effects.size() < 2) return "";
  std::string text = "Evidence of each effect beside the others:";
  for (const AddedEffect& e : a.effects)
    text += fmt::format("{} {} {:.1f}", &e == a.effects.data() ? "" : ",", e.name, e.evidence);
  return text + ".\n";
}

report::Table values_table(const Addition& a) {
  report::Table t{
      "Parameters",
      {"parameter", "unit", "start", "value", "std. error", "95 % interval", "variance reduction", ""},
      {}};
  for (std::size_t i = 0; i < a.parameters.size(); ++i) {
    const auto& p = a.parameters[i];
    const bool own = i < static_cast<std::size_t>(a.own);
    t.rows.push_back(
        {p.full_name(), p.unit, fmt::format("{:.4g}", p.start), fmt::format("{:.4g}", p.value),
         fmt::format("{:.2g}", p.error), fmt::format("{:.4g} to {:.4g}", p.low, p.high),
         fmt::format("{:.0f} %", 100 * p.decided),
         std::string(own ? "added" : "") + (p.at_bound ? " at its bound: interval not valid" : "")});
  }
  return t;
}

}  // namespace

report::Table addition_table(const Addition& a) {
  report::Table t{"Events", {"event", "use", "chi2/value before", "refitted", "after", "limit"}, {}};
  for (const auto& event : a.events) {
    const calibrate::EventScore& e = event.score;
    t.rows.push_back({e.record, calibrate::use_name(e), fmt::format("{:.3g}", e.before),
                      fmt::format("{:.3g}", event.refitted),
                      fmt::format("{:.3g}{}", e.after, e.adequate() ? "" : " !"),
                      fmt::format("{:.3g}", e.limit)});
  }
  return t;
}

std::string terminal_report(const Addition& a) {
  return a.sentence + "\n\n" + report::padded(addition_table(a), 1) + "\n" +
         report::padded(values_table(a), 1) +
         fmt::format(
             "\nEvidence, 2 ln(Bayes factor): {:.1f}; above {:g}: very strong (Kass and Raftery 1995).\n{}\n",
             a.evidence, thresholds::addition.strong.value, judged_by(a)) +
         evidence_beside(a);
}

json addition_json(const Addition& a) {
  json j = {{"effect", a.hypothesis.name},
            {"what", a.hypothesis.what},
            {"effects", json::array()},
            {"side", hypothesis::side_name(a.hypothesis.side)},
            {"sentence", a.sentence},
            {"accepted", a.earns},
            {"adequate", a.adequate},
            {"adequacy", thresholds::ruling_json(a.ruling)},
            {"evidence_needed", thresholds::addition.strong.value},
            {"evidence", a.evidence},
            {"reduced_chi2_refitted_without", a.without.reduced_chi2()},
            {"reduced_chi2_with", a.with.reduced_chi2()},
            {"seconds", a.seconds},
            {"events", json::array()},
            {"parameters", json::array()}};
  for (const AddedEffect& e : a.effects)
    j["effects"].push_back({{"effect", e.name}, {"what", e.what}, {"evidence", e.evidence}});
  for (const auto& e : a.events) {
    json event = calibrate::event_json(e.score);
    event["reduced_chi2_refitted_without"] = e.refitted;
    j["events"].push_back(event);
  }
  for (std::size_t i = 0; i < a.parameters.size(); ++i) {
    json p = diagnose::parameter_json(a.parameters[i]);
    p["added"] = i < static_cast<std::size_t>(a.own);
    j["parameters"].push_back(std::move(p));
  }
  return j;
}

std::vector<std::string> provenance_lines(const Addition& a, const plant::PlantModel& from,
                                          const std::string& command_line) {
  std::string fitted, unseen;
  for (std::size_t e = 0; e < a.events.size(); ++e) {
    auto& list = a.events[e].score.seen ? fitted : unseen;
    list += fmt::format("{}{} (SHA-256 {})", list.empty() ? "" : ", ", a.prepared[e].record.name,
                        a.prepared[e].record.sha256);
  }
  std::vector<std::string> lines = {
      fmt::format("{} added by swingbank {} on {:%Y-%m-%d %H:%M} UTC.", a.hypothesis.what, SWINGBANK_VERSION,
                  fmt::gmtime(std::time(nullptr))),
      "Command: " + command_line,
      fmt::format("Added to the model {} (SHA-256 {}).", from.origin, from.sha256), "Fitted to: " + fitted};
  if (!unseen.empty()) lines.push_back("Held-out events: " + unseen);
  lines.push_back(a.sentence);
  return lines;
}

std::string terminal_report(const Completion& c) {
  std::string text;
  for (const auto& a : c.added) text += terminal_report(a) + "\n";
  for (const auto& r : c.removed)
    text += fmt::format("{} removed: its evidence fell to {:.1f} (required: above {:g}).\n", r.effect,
                        r.evidence, thresholds::addition.stays.value);
  return text + c.sentence + "\n";
}

json completion_json(const Completion& c) {
  json j = {{"sentence", c.sentence},
            {"adequate", c.adequate},
            {"added", json::array()},
            {"removed", json::array()}};
  for (const auto& a : c.added) j["added"].push_back(addition_json(a));
  for (const auto& r : c.removed) j["removed"].push_back({{"effect", r.effect}, {"evidence", r.evidence}});
  return j;
}

}  // namespace swingbank::validate::add
