#include "validate/calibrate/report.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "validate/thresholds/list.hpp"

namespace swingbank::validate::calibrate {
namespace {

using nlohmann::json;

std::string percent(double share) { return fmt::format("{:.0f} %", 100 * share); }

/// Returns whether a value is so far from the model's value that the prior biases it and correlated
/// parameters.
bool strained(const fit::FittedParameter& p) {
  const bool logarithmic = p.start > 0 && p.value > 0;
  const double moved = logarithmic ? std::abs(std::log(p.value / p.start)) : 0.0;
  return p.where.prior_sd > 0 && moved > thresholds::parameters.beyond_prior * p.where.prior_sd;
}

std::string notes(const Calibration& c, std::size_t i) {
  const auto& p = c.parameters[i];
  std::string text = p.fit.at_bound ? "at its bound: interval not valid" : "";
  if (strained(p.fit)) text += std::string(text.empty() ? "" : "; ") + "outside the prior (--prior-sd)";
  if (p.fit.decided < thresholds::parameters.identified)
    text += std::string(text.empty() ? "" : "; ") + "not identified";
  return text;
}

std::string identify_text(const Calibration& c) {
  std::string text;
  if (c.candidates.empty()) return text;
  for (const auto& p : c.parameters) {
    if (p.fit.decided >= thresholds::parameters.identified) continue;
    text += fmt::format("  {}: ", p.fit.full_name());
    text += p.best_candidate < 0
                ? std::string("no simulated event reduces the standard error by a fifth or more\n")
                : fmt::format("{} reduces the standard error by a factor of {:.1f} ({:.2g} -> {:.2g} {})\n",
                              c.candidates[static_cast<std::size_t>(p.best_candidate)].what, 1 / p.narrowed,
                              p.fit.error, p.fit.error * p.narrowed, p.fit.unit);
  }
  return text;
}

std::string starts_text(const Calibration& c) {
  std::string text = "Starts, reduced chi-square before -> after, white noise assumed:";
  for (const auto& s : c.started)
    text += fmt::format(" {} {:.3g} -> {:.3g}{};", s.name, s.before, s.after,
                        s.agrees ? "" : " (another optimum)");
  text.back() = '.';
  return text + "\n";
}

json parameter_json(const Calibration& c, std::size_t i) {
  const auto& p = c.parameters[i];
  json j = {{"effect", p.fit.block},
            {"name", p.fit.name},
            {"unit", p.fit.unit},
            {"start", p.fit.start},
            {"value", p.fit.value},
            {"standard_error", p.fit.error},
            {"standard_error_white_noise", p.curvature_error},
            {"low_95", p.fit.low},
            {"high_95", p.fit.high},
            {"variance_reduction", p.fit.decided},
            {"voltage_noise_correction", p.shift},
            {"at_bound", p.fit.at_bound},
            {"outside_prior", strained(p.fit)}};
  j["most_informative_event"] =
      p.best_candidate < 0 ? json(nullptr)
                           : json{{"event", c.candidates[static_cast<std::size_t>(p.best_candidate)].what},
                                  {"factor", p.narrowed}};
  return j;
}

}  // namespace

std::string adequacy_name(Adequacy adequacy) {
  switch (adequacy) {
    case Adequacy::adequate:
      return "adequate";
    case Adequacy::parameters_poor:
      return "parameter values were wrong";
    case Adequacy::structure_poor:
      break;
  }
  return "structure not adequate";
}

std::string describe(const Calibration& c, const UnidentifiedCombination& combination) {
  std::string members;
  for (const auto& m : combination.members) {
    const auto& p = c.parameters[static_cast<std::size_t>(m.parameter)].fit;
    members += fmt::format("{}{} {:+.2g} {}", members.empty() ? "" : ", ", p.full_name(), m.change, p.unit);
  }
  if (combination.alone())
    return c.parameters[static_cast<std::size_t>(combination.members.front().parameter)].fit.full_name() +
           " alone has no significant influence on these records (" + percent(combination.decided) +
           " determined)";
  return "not identified separately: " + members +
         " together have no significant influence on these records (" + percent(combination.decided) +
         " determined)";
}

report::Table parameter_table(const Calibration& c) {
  report::Table t{
      "Parameters",
      {"parameter", "unit", "start", "value", "std. error", "95 % interval", "variance reduction", ""},
      {}};
  for (std::size_t i = 0; i < c.parameters.size(); ++i) {
    const auto& p = c.parameters[i].fit;
    t.rows.push_back({p.full_name(), p.unit, fmt::format("{:.4g}", p.start), fmt::format("{:.4g}", p.value),
                      fmt::format("{:.2g}", p.error), fmt::format("{:.4g} to {:.4g}", p.low, p.high),
                      percent(p.decided), notes(c, i)});
  }
  return t;
}

report::Table event_table(const std::vector<EventScore>& events) {
  report::Table t{"Events", {"event", "use", "red. chi2 before", "after", "limit"}, {}};
  for (const auto& e : events) {
    t.rows.push_back({e.record, use_name(e), fmt::format("{:.3g}", e.before),
                      fmt::format("{:.3g}{}", e.after, e.adequate() ? "" : " !"),
                      fmt::format("{:.3g}", e.limit)});
  }
  return t;
}

std::string terminal_report(const Calibration& c) {
  std::string text = c.sentence + "\n\n" + report::padded(event_table(c.events), 1) + "\n" +
                     report::padded(parameter_table(c), 1);
  text += fmt::format("\n{} of {} starts reached this optimum{}.\n", c.agreeing, c.started.size(),
                      c.converged ? "" : "; the search reached its iteration limit");
  if (c.started.size() > 1) text += starts_text(c);
  const auto coloured = std::ranges::max_element(c.events, {}, &EventScore::colour);
  if (coloured->colour > 0.2)
    text += fmt::format(
        "The noise is coloured: neighbouring samples before the event correlate by {:.2f} in {}; "
        "limits and standard errors are widened accordingly.\n",
        coloured->colour, coloured->record);
  if (std::ranges::any_of(c.parameters, [](const auto& p) { return strained(p.fit); }))
    text +=
        "Some values are far outside the prior (--prior-sd). The prior then biases them and correlated "
        "values. Calibrate again from the new model, or with a larger --prior-sd.\n";
  for (const auto& combination : c.unidentified) text += "- " + describe(c, combination) + "\n";
  const std::string events = identify_text(c);
  if (!events.empty()) text += "Next measurement for each parameter that is not identified:\n" + events;
  return text;
}

std::string use_name(const EventScore& e) { return e.seen ? "fit" : "verification"; }

json event_json(const EventScore& e) {
  return {{"record", e.record},
          {"seen", e.seen},
          {"use", use_name(e)},
          {"reduced_chi2_before", e.before},
          {"reduced_chi2_after", e.after},
          {"reduced_chi2_limit", e.limit},
          {"reduced_chi2_limit_noise", e.limit - e.allowance},
          {"adequate", e.adequate()},
          {"noise_correlation", e.colour}};
}

json calibration_json(const Calibration& c) {
  json j = {{"verdict", adequacy_name(c.adequacy)},
            {"adequacy", thresholds::ruling_json(c.ruling)},
            {"sentence", c.sentence},
            {"reduced_chi2_before", c.before},
            {"reduced_chi2_after", c.after},
            {"reduced_chi2_limit", c.limit},
            {"starts", c.started.size()},
            {"starts_agreeing", c.agreeing},
            {"started", json::array()},
            {"converged", c.converged},
            {"voltage_noise_share", c.voltage_noise},
            {"seconds", c.seconds},
            {"events", json::array()},
            {"parameters", json::array()},
            {"correlation", json::array()},
            {"unidentified_combinations", json::array()},
            {"events_tried", json::array()}};
  for (const auto& s : c.started)
    j["started"].push_back({{"name", s.name},
                            {"reduced_chi2_before", s.before},
                            {"reduced_chi2_after", s.after},
                            {"agrees", s.agrees}});
  for (const auto& e : c.events) j["events"].push_back(event_json(e));
  for (std::size_t i = 0; i < c.parameters.size(); ++i) {
    j["parameters"].push_back(parameter_json(c, i));
    json row = json::array();
    for (Eigen::Index k = 0; k < c.correlation.cols(); ++k)
      row.push_back(c.correlation(static_cast<Eigen::Index>(i), k));
    j["correlation"].push_back(row);
  }
  for (const auto& combination : c.unidentified) {
    json members = json::array();
    for (const auto& m : combination.members) {
      const auto& p = c.parameters[static_cast<std::size_t>(m.parameter)].fit;
      members.push_back({{"parameter", p.full_name()}, {"change", m.change}, {"unit", p.unit}});
    }
    j["unidentified_combinations"].push_back(
        {{"members", members}, {"variance_reduction", combination.decided}});
  }
  for (const auto& candidate : c.candidates)
    j["events_tried"].push_back({{"event", candidate.what}, {"standard_errors", candidate.error}});
  return j;
}

std::vector<std::string> provenance_lines(const Calibration& c, const std::string& command_line) {
  std::string fitted, unseen;
  for (const auto& e : c.prepared) {
    const auto score = std::ranges::find(c.events, e.record.name, &EventScore::record);
    auto& list = score == c.events.end() || score->seen ? fitted : unseen;
    list += fmt::format("{}{} (SHA-256 {})", list.empty() ? "" : ", ", e.record.name, e.record.sha256);
  }
  std::string names;
  for (const auto& p : c.parameters) names += (names.empty() ? "" : ", ") + p.fit.full_name();
  std::vector<std::string> lines = {
      fmt::format("Calibrated by swingbank {} on {:%Y-%m-%d %H:%M} UTC.", SWINGBANK_VERSION,
                  fmt::gmtime(std::time(nullptr))),
      "Command: " + command_line,
      fmt::format("From the model {} (SHA-256 {}).", c.model.origin, c.model.sha256), "Fitted to: " + fitted};
  if (!unseen.empty()) lines.push_back("Held-out events: " + unseen);
  lines.push_back("Fitted parameters: " + names + "; every other value is as in that model.");
  lines.push_back(fmt::format("Reduced chi-square {:.4g} before, {:.4g} after: {}.", c.before, c.after,
                              adequacy_name(c.adequacy)));
  return lines;
}

}  // namespace swingbank::validate::calibrate
