#include "validate/fleet/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <tuple>

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

std::string probability_of(const FleetRow& r, const std::string& name) {
  const auto p = r.probabilities.find(name);
  return p == r.probabilities.end() ? "" : report::probability_text(p->second);
}
/// Returns the text of the effects, for example "SEXS 97 %", "TGOV1 + SEXS 88 %", "SEXS 62 % or ESST1A 34 %",
/// or "SEXS 49 % or 3 others".
std::string effect_text(const FleetRow& r) {
  std::vector<std::string> all;
  if (!r.effects.empty()) all.push_back(joined(r.effects, " + "));
  all.insert(all.end(), r.equivalent.begin(), r.equivalent.end());
  if (all.empty()) return "none";
  for (auto& name : all) {
    const std::string probability = probability_of(r, name);
    name += (probability.empty() ? "" : " ") + probability;
  }
  return all.size() > 2 ? fmt::format("{} or {} others", all.front(), all.size() - 1) : joined(all, " or ");
}
std::string chance_text(double chance) {
  if (!std::isfinite(chance)) return "–";
  return chance < 1e-12 ? "< 1e-12" : fmt::format("≤ {:.0e}", chance);
}
std::string number_text(double v) { return std::isfinite(v) ? fmt::format("{:.6g}", v) : ""; }

/// Kind of result: id of its first row on the page, name and colour.
struct Kind {
  const char *id, *name;
  report::Tone tone;
  double shade;  ///< shade of the verdict's cell, 0 to 1
};
/// Kinds in the order of the rows. Failed plants come late, because nothing shows that their models are
/// wrong.
constexpr std::array<Kind, 5> kKinds = {{{"unexplained", "unexplained", report::Tone::bad, 1.0},
                                         {"missing", "with a missing effect", report::Tone::warn, 0.7},
                                         {"refit", "adequate after refit", report::Tone::warn, 0.3},
                                         {"failed", "failed", report::Tone::bad, 1.0},
                                         {"adequate", "adequate", report::Tone::good, 0.0}}};
/// Returns the position of a row's kind in kKinds.
std::size_t kind_of(const FleetRow& r) {
  if (r.verdict == "unexplained") return 0;
  if (r.verdict == "missing" || r.verdict == "confusable") return 1;
  if (r.failed()) return 3;
  if (r.verdict != "adequate") throw std::logic_error("unknown verdict of a fleet row: " + r.verdict);
  return r.adequate() ? 4 : 2;
}
int count(const std::vector<FleetRow>& rows, std::size_t kind) {
  return static_cast<int>(std::ranges::count(rows, kind, kind_of));
}
std::string verdict_text(const FleetRow& r) {
  return kind_of(r) == 1 ? "effect missing" : kKinds.at(kind_of(r)).name;
}

std::string percent_text(double v) { return std::isfinite(v) ? fmt::format("{:.3g} %", v) : "–"; }
report::Cell fit_cell(const SubmittedError& e) {
  if (e.fit == "not judged") return "–";
  return {e.fit, e.fit == "yes" ? 0.0 : 1.0};
}

std::vector<report::Cell> row_cells(const FleetRow& r) {
  report::Cell verdict(verdict_text(r), kKinds[kind_of(r)].shade);
  verdict.hint = r.sentence;
  if (r.failed()) return {r.plant, verdict, "–", "–", "–", "–", "–", "–", "–", "–"};
  const bool judged = std::isfinite(r.unseen_after);
  const SubmittedError& e = r.error;
  return {r.plant,
          verdict,
          effect_text(r),
          r.side,
          percent_text(e.percent),
          e.channel.empty() ? "–" : fmt::format("{}, {}, {}", e.channel, e.window, e.event),
          fit_cell(e),
          report::times_noise(r.left),
          judged ? report::times_noise(r.unseen_before) + " → " + report::times_noise(r.unseen_after) : "–",
          chance_text(r.chance)};
}

/// Returns a sort key for descending order of `v`; NaN comes last.
double descending(double v) { return std::isnan(v) ? 1 : -v; }

/// Returns the path of a plant's report, relative to the folder of the table; empty: none.
std::string report_of(const FleetRow& r) { return r.failed() ? "" : r.plant + "/report.html"; }

constexpr const char* kCaption =
    "The worst plant first: by verdict, then by the largest error of P and Q of the submitted model [% of the "
    "machine's MVA], judged for fitness for purpose. “Refitted”: normalised RMS over all channels (square root "
    "of the reduced chi-square; noise alone gives 1 ×) of the submitted model with fitted parameters. “Held "
    "out”: the same over events excluded from the fit, before and after the effect is added. Last column: bound "
    "of the probability that noise alone gives any hypothesis this evidence.";

/// Adds the problems of the plants that could not be diagnosed.
void add_failures(report::Document& page, const std::vector<FleetRow>& rows) {
  report::Table table{"", {"plant", "problem"}, {}};
  for (const auto& r : rows)
    for (std::size_t at = 0; r.failed() && at < r.sentence.size();) {  // a problem per line
      const std::size_t end = std::min(r.sentence.find('\n', at), r.sentence.size());
      table.rows.push_back({at == 0 ? r.plant : "", r.sentence.substr(at, end - at)});
      at = end + 1;
    }
  if (table.rows.empty()) return;
  page.section("Plants without a diagnosis");
  page.add(table);
}

}  // namespace

void sort_worst_first(std::vector<FleetRow>& rows) {
  std::ranges::sort(rows, {}, [](const FleetRow& r) {
    return std::tuple(kind_of(r), descending(r.error.percent), descending(r.left), r.plant);
  });
}

report::Table fleet_table(const std::vector<FleetRow>& rows) {
  report::Table table{
      "",
      {"plant", "verdict", "missing effect", "side", "largest error [% of MVA]", "channel, window, event",
       "fit for purpose", "refitted", "held out: before → after", "probability under noise"},
      {}};
  for (const auto& r : rows) table.rows.push_back(row_cells(r));
  return table;
}

std::string fleet_summary(const std::vector<FleetRow>& rows) {
  std::string text = fmt::format("{} {}:", rows.size(), rows.size() == 1 ? "plant" : "plants");
  for (std::size_t k = 0; k < kKinds.size(); ++k)
    text += fmt::format("{} {} {}", k == 0 ? "" : ",", count(rows, k), kKinds.at(k).name);
  return text + ".";
}

std::string fleet_caution(const std::vector<FleetRow>& rows) {
  double any = 0;  // expected number of effects named because of noise alone
  bool named = false;
  for (const auto& r : rows)
    if (std::isfinite(r.chance)) any += r.chance, named = true;
  std::string text = "False verdicts: ";
  if (named)
    text += fmt::format(
        "the probability that noise alone caused any of the named effects is at most {:.0e}. Not "
        "included: noise of the played-in voltage, wrong instruments, records of another plant and "
        "unlisted effects. ",
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
  nlohmann::json j = {{"format", "swingbank-fleet-5"},
                      {"fleet", fleet.file.string()},
                      {"software", "swingbank " SWINGBANK_VERSION},
                      {"summary", fleet_summary(rows)},
                      {"caution", fleet_caution(rows)},
                      {"adequate", std::ranges::count_if(rows, &FleetRow::adequate)},
                      {"failed", std::ranges::count_if(rows, &FleetRow::failed)},
                      {"plants", nlohmann::json::array()}};
  for (const auto& r : rows) j["plants"].push_back(row_json(r));
  return json_text(j, 1) + "\n";
}

std::string fleet_csv(const std::vector<FleetRow>& rows) {
  report::Table table{"",
                      {"plant",
                       "verdict",
                       "effects",
                       "probability [%]",
                       "equivalent",
                       "equivalent_probabilities [%]",
                       "side",
                       "largest_error [% of MVA]",
                       "channel",
                       "window",
                       "event",
                       "fit_for_purpose",
                       "evidence [2 ln(Bayes factor)]",
                       "refitted [normalised RMS]",
                       "held_out_before [normalised RMS]",
                       "held_out_after [normalised RMS]",
                       "probability_under_noise_at_most [%]",
                       "events",
                       "report",
                       "sentence",
                       "inputs_sha256"},
                      {}};
  const auto percent = [](const FleetRow& r, const std::string& name) {
    const auto p = r.probabilities.find(name);
    return p == r.probabilities.end() ? "" : number_text(100 * p->second);
  };
  for (const auto& r : rows) {
    std::vector<std::string> others;
    for (const auto& name : r.equivalent) others.push_back(percent(r, name));
    table.rows.push_back({r.plant,
                          r.verdict,
                          joined(r.effects, ";"),
                          percent(r, joined(r.effects, " + ")),
                          joined(r.equivalent, ";"),
                          joined(others, ";"),
                          r.side,
                          number_text(r.error.percent),
                          r.error.channel,
                          r.error.window,
                          r.error.event,
                          r.error.fit,
                          number_text(r.evidence),
                          number_text(r.left),
                          number_text(r.unseen_before),
                          number_text(r.unseen_after),
                          number_text(100 * r.chance),
                          std::to_string(r.events),
                          report_of(r),
                          r.sentence,
                          r.inputs});
  }
  return report::csv(table);
}

std::string fleet_html(const Fleet& fleet, const std::vector<FleetRow>& rows) {
  report::Document page{"Fleet: " + fleet.file.stem().string(),
                        "each plant is diagnosed from its own records"};
  const int adequate = count(rows, kKinds.size() - 1);
  const bool good = adequate == static_cast<int>(rows.size()),
             bad = std::ranges::any_of(
                 rows, [](const auto&r) { return kKinds[kind_of(r)].tone == report::Tone::bad; });
  page.add(report::Opening{fmt::format("{} of {} plants {} adequate as submitted", adequate, rows.size(),
                                       adequate == 1 ? "is" : "are"),
                           {fleet_summary(rows)},
                           good  ? report::Tone::good
                           : bad ? report::Tone::bad
                                 : report::Tone::found});
  report::Table table = fleet_table(rows);
  table.caption = kCaption;
  table.sortable = true;
  for (std::size_t i = 0; i < rows.size(); ++i) table.rows[i].front().link = report_of(rows[i]);
  report::Chips::Group chips{"", {}};
  for (std::size_t k = 0; k < kKinds.size(); ++k) {
    const auto first = std::ranges::find(rows, k, kind_of);
    if (first == rows.end()) continue;
    const Kind& kind = kKinds.at(k);
    table.rows[static_cast<std::size_t>(first - rows.begin())].front().id = kind.id;
    chips.chips.push_back({kind.name, std::to_string(count(rows, k)), kind.tone, kind.id,
                           "go to the first plant with this result"});
  }
  page.add(report::Chips{{chips}});
  page.add(report::Paragraph{"fleet.csv: this table for a spreadsheet", report::Paragraph::Kind::hint, true,
                             "fleet.csv"});
  page.add(table);
  add_failures(page, rows);
  page.note(fleet_caution(rows));
  page.provenance({{"command", "swingbank diagnose --fleet " + fleet.file.string()},
                   {"software", "swingbank " SWINGBANK_VERSION}});
  page.add(report::Data{"figures", fleet_json(fleet, rows)});
  return report::html(page);
}

int fleet_code(const std::vector<FleetRow>& rows) {
  if (std::ranges::any_of(rows, &FleetRow::failed)) return 1;
  return std::ranges::all_of(rows, &FleetRow::adequate) ? 0 : thresholds::kNotAdequate;
}

}  // namespace swingbank::validate::fleet
