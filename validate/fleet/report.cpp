#include "validate/fleet/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/json.hpp"
#include "validate/report/figures.hpp"
#include "validate/thresholds/adequacy.hpp"

namespace swingbank::validate::fleet {
namespace {

std::string joined(const std::vector<std::string>& words, const char* between) {
  std::string all;
  for (const auto& w : words) all += (all.empty() ? "" : between) + w;
  return all;
}
std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

/// Text of the effects: "SEXS 97 %", "TGOV1 + SEXS 88 %", "SEXS 62 % or ESST1A 34 %".
std::string effect_text(const FleetRow& r) {
  const auto with_probability = [&](const std::string& name) {
    const auto p = r.probabilities.find(name);
    return p == r.probabilities.end() ? name : name + " " + report::probability_text(p->second);
  };
  std::string text = r.effects.empty() ? "" : with_probability(joined(r.effects, " + "));
  for (const auto& other : r.equivalent) text += (text.empty() ? "" : " or ") + with_probability(other);
  return text.empty() ? "–" : text;
}
std::string chance_text(double chance) {
  if (!std::isfinite(chance)) return "–";
  return chance < 1e-12 ? "< 1e-12" : fmt::format("≤ {:.0e}", chance);
}
std::string number_text(double v) { return std::isfinite(v) ? fmt::format("{:.6g}", v) : ""; }

double verdict_shade(const FleetRow& r) {
  return r.adequate() ? 0.0 : r.failed() || r.verdict == "unexplained" ? 1.0 : 0.5;
}

std::vector<report::Cell> row_cells(const FleetRow& r) {
  if (r.failed()) return {r.plant, report::Cell(r.verdict, 1.0), "–", "–", "–", "–", "–", "–"};
  const bool judged = std::isfinite(r.unseen_after);
  return {r.plant,
          report::Cell(r.verdict, verdict_shade(r)),
          effect_text(r),
          r.side == "none" ? "–" : r.side,
          std::isfinite(r.evidence) ? fmt::format("{:.0f}", r.evidence) : "–",
          report::times_noise(r.left),
          judged ? report::times_noise(r.unseen_before) + " → " + report::times_noise(r.unseen_after) : "–",
          chance_text(r.chance)};
}

int count(const std::vector<FleetRow>& rows, std::initializer_list<const char*> verdicts) {
  return static_cast<int>(std::ranges::count_if(rows, [&](const FleetRow& r) {
    return std::ranges::any_of(verdicts, [&](const char* v) { return r.verdict == v; });
  }));
}

}  // namespace

report::Table fleet_table(const std::vector<FleetRow>& rows) {
  report::Table table{
      "Errors are normalised RMS over all channels (square root of the reduced chi-square): "
      "noise alone gives 1 ×. “Refitted”: submitted model with fitted parameters. “Held out”: "
      "events excluded from the fit, without and with the effect. Last column: bound of the "
      "probability that noise alone gives any hypothesis this evidence.",
      {"plant", "verdict", "effect", "side", "evidence", "error, refitted", "held out: before → after",
       "probability under noise"},
      {}};
  for (const auto& r : rows) table.rows.push_back(row_cells(r));
  return table;
}

std::string fleet_summary(const std::vector<FleetRow>& rows) {
  return fmt::format("{} {}: {} adequate, {} with an effect named, {} unexplained, {} failed.", rows.size(),
                     rows.size() == 1 ? "plant" : "plants", count(rows, {"adequate"}),
                     count(rows, {"missing", "confusable"}), count(rows, {"unexplained"}),
                     count(rows, {"failed"}));
}

std::string fleet_caution(const std::vector<FleetRow>& rows) {
  double any = 0;  // expected number of effects named because of noise alone
  bool named = false;
  for (const auto& r : rows)
    if (std::isfinite(r.chance)) any += r.chance, named = true;
  std::string text = "False verdicts: ";
  if (named)
    text += fmt::format(
        "under noise alone, the probability of an effect at any plant with a named effect is at "
        "most {:.0e}. This excludes noise of the played-in voltage, wrong instruments, records "
        "of another plant and unlisted effects. ",
        std::clamp(any, 1e-12, 1.0));
  return text +
         "Measured rates of false positives and of missed effects: docs/reference/blind-test-results.md.";
}

std::string fleet_text(const std::vector<FleetRow>& rows) {
  std::string text = report::padded(fleet_table(rows), 4);
  for (const auto& r : rows)
    if (r.failed()) text += fmt::format("{} failed: {}\n", r.plant, first_line(r.sentence));
  return text + "\n" + fleet_summary(rows) + "\n" + fleet_caution(rows) + "\n";
}

std::string fleet_json(const Fleet& fleet, const std::vector<FleetRow>& rows) {
  nlohmann::json j = {{"format", "swingbank-fleet-3"},
                      {"fleet", fleet.file.string()},
                      {"software", "swingbank " SWINGBANK_VERSION},
                      {"summary", fleet_summary(rows)},
                      {"caution", fleet_caution(rows)},
                      {"adequate", count(rows, {"adequate"})},
                      {"failed", count(rows, {"failed"})},
                      {"plants", nlohmann::json::array()}};
  for (const auto& r : rows) j["plants"].push_back(row_json(r));
  return json_text(j, 1) + "\n";
}

std::string fleet_csv(const std::vector<FleetRow>& rows) {
  report::Table table{
      "",
      {"plant", "verdict", "effects", "equivalent", "side", "evidence", "normalised_rms_refitted",
       "unseen_normalised_rms_before", "unseen_normalised_rms_after", "probability_by_noise_alone_at_most",
       "events", "sentence", "inputs_sha256"},
      {}};
  for (const auto& r : rows)
    table.rows.push_back({r.plant, r.verdict, joined(r.effects, ";"), joined(r.equivalent, ";"), r.side,
                          number_text(r.evidence), number_text(r.left), number_text(r.unseen_before),
                          number_text(r.unseen_after), number_text(r.chance), std::to_string(r.events),
                          r.sentence, r.inputs});
  return report::csv(table);
}

std::string fleet_html(const Fleet& fleet, const std::vector<FleetRow>& rows) {
  report::Document page{"Fleet: " + fleet.file.stem().string(), "every plant diagnosed from its own records"};
  const bool good = fleet_code(rows) == 0, failed = count(rows, {"failed", "unexplained"}) > 0;
  const auto adequate = count(rows, {"adequate"});
  page.add(report::Opening{
      fmt::format("{} of {} plants {} adequate", adequate, rows.size(), adequate == 1 ? "is" : "are"),
      {fleet_summary(rows)},
      good     ? report::Tone::good
      : failed ? report::Tone::bad
               : report::Tone::found});
  report::Table table = fleet_table(rows);
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (!rows[i].failed()) table.rows[i].front().link = rows[i].plant + "/report.html";
  page.add(table);
  page.note(fleet_caution(rows));
  page.section("Verdicts");
  for (const auto& r : rows) {
    page.subsection(r.plant);
    for (std::size_t at = 0; at < r.sentence.size();) {  // a problem per line
      const std::size_t end = std::min(r.sentence.find('\n', at), r.sentence.size());
      page.text(r.sentence.substr(at, end - at));
      at = end + 1;
    }
  }
  page.provenance({{"command", "swingbank diagnose --fleet " + fleet.file.string()},
                   {"software", "swingbank " SWINGBANK_VERSION}});
  page.add(report::Data{"figures", fleet_json(fleet, rows)});
  return report::html(page);
}

int fleet_code(const std::vector<FleetRow>& rows) {
  if (count(rows, {"failed"}) > 0) return 1;
  return std::ranges::all_of(rows, &FleetRow::adequate) ? 0 : thresholds::kNotAdequate;
}

}  // namespace swingbank::validate::fleet
