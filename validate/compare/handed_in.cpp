#include "validate/compare/handed_in.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/json.hpp"

namespace swingbank::validate::compare {
namespace {

using usability::UsabilityAt;

std::string percent_of_mva(double value) { return fmt::format("{:.2g}", value); }
/// Returns a drift [% of MVA] as text; "< e" if it is below the error e of the simulation.
std::string drift_text(double drift) {
  const double error = 100 * usability::kSampleError;
  return drift < error ? fmt::format("< {:g}", error) : percent_of_mva(drift);
}
std::string yes_or_no(bool value) { return value ? "yes" : "no"; }

std::string missing_text(const HandedIn& model) {
  std::string keys;
  for (const auto& line : model.nameplate)
    if (line.missing) keys += (keys.empty() ? "" : ", ") + line.key;
  return keys.empty() ? "" : fmt::format("Missing under [nameplate] of {}: {}.", model.file, keys);
}

report::Table usability_table(const HandedIn& model) {
  const usability::Usability& u = model.usability;
  report::Table table{
      fmt::format(
          "Simulated for {:g} s from the operating point of each event, against an infinite bus behind {:g} pu "
          "on {:g} MVA. Drift: largest deviation of P or Q without a disturbance; reported without a limit. "
          "Oscillation: least damped mode of P and Q after a {}; amplitude: the larger of this mode's amplitudes in P "
          "and Q just after the step. Damped: the machine stays in synchronism, the changes of P and Q decrease from "
          "the first to the second half, and the damping ratio is positive (Kundur 1994, 12.1).",
          usability::kStudyDuration, usability::kStudyReactance, model.mva, u.step),
      {"event", "P [MW]", "Q [Mvar]", "V [pu]", "initialises", "drift [% of MVA]", "oscillation [Hz]",
       "damping ratio [%]", "amplitude [% of MVA]", "damped"},
      {}};
  for (const UsabilityAt& at : u.at) {
    const bool simulated = at.failure.empty();
    std::vector<report::Cell> row = {
        at.state.event, fmt::format("{:.2f}", at.state.P), fmt::format("{:.2f}", at.state.Q),
        fmt::format("{:.4f}", std::abs(at.state.voltage)), yes_or_no(at.initialises)};
    row.emplace_back(simulated ? drift_text(std::max(at.drift_P, at.drift_Q)) : "–");
    const auto& o = at.oscillation;
    row.emplace_back(o ? fmt::format("{:.2f}", o->frequency) : "–");
    row.emplace_back(o ? fmt::format("{:.1f}", 100 * o->damping) : "–");
    row.emplace_back(o ? percent_of_mva(o->amplitude) : "–");
    row.emplace_back(simulated ? yes_or_no(at.damped) : "–");
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

HandedIn handed_in(const plant::PlantModel& model, const std::vector<EventComparison>& events) {
  std::vector<usability::OperatingState> states;
  for (const EventComparison& e : events) {
    const double mva = e.record.base.mva;
    states.push_back(
        {e.record.name, e.playback.start.voltage, e.playback.start.P * mva, e.playback.start.Q * mva});
  }
  return {model.name,
          model.origin,
          model.sha256,
          model.plant.mva,
          plant::nameplate_lines(model.nameplate, model.whole ? *model.whole : model.plant),
          usability::check_usability(model, states)};
}

void nameplate_part(report::Document& page, const HandedIn& model) {
  page.section("Model information");
  page.text(missing_text(model));
  report::Facts facts;
  for (const auto& line : model.nameplate) facts.rows.emplace_back(line.label, line.text());
  page.add(facts);
}

void usability_part(report::Document& page, const HandedIn& model) {
  const usability::Usability& u = model.usability;
  page.section("Usability");
  const auto tone = !u.not_checked.empty() ? report::Tone::warn
                    : u.usable()           ? report::Tone::good
                                           : report::Tone::bad;
  page.add(report::Verdict{u.verdict() + (u.not_checked.empty() ? "." : ": " + u.not_checked + "."), tone});
  for (const UsabilityAt& at : u.at)
    if (!at.failure.empty()) page.note(at.state.event + ": " + at.failure);
  if (!u.at.empty()) page.add(usability_table(model));
}

std::string handed_in_text(const HandedIn& model) {
  const usability::Usability& u = model.usability;
  std::string text = "Usability: " + u.verdict();
  if (!u.not_checked.empty()) text += " (" + u.not_checked + ")";
  double drift = 0;
  const usability::Oscillation* least = nullptr;
  for (const UsabilityAt& at : u.at) {
    drift = std::max({drift, at.drift_P, at.drift_Q});
    if (at.oscillation && (!least || at.oscillation->damping < least->damping)) least = &*at.oscillation;
  }
  if (u.not_checked.empty())
    text += fmt::format("; drift in {:g} s {} % of MVA", usability::kStudyDuration, drift_text(drift));
  if (least)
    text +=
        fmt::format("; minimum damping ratio {:.1f} % at {:.2f} Hz", 100 * least->damping, least->frequency);
  text += "\n";
  for (const UsabilityAt& at : u.at)
    if (!at.failure.empty()) text += fmt::format("  {}: {}\n", at.state.event, at.failure);
  const std::string missing = missing_text(model);
  return missing.empty() ? text : text + missing + "\n";
}

nlohmann::json nameplate_json(const HandedIn& model) {
  nlohmann::json j = {{"given", nlohmann::json::object()}, {"missing", nlohmann::json::array()}};
  for (const auto& line : model.nameplate)
    if (line.missing)
      j["missing"].push_back(line.key);
    else
      std::visit([&](const auto& value) { j["given"][line.key] = value; }, line.value);
  return j;
}

}  // namespace swingbank::validate::compare
