// Report of a system comparison as terminal text, JSON and page.
#include "validate/compare/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/json.hpp"
#include "validate/compare/error_map_table.hpp"
#include "validate/compare/first_screen.hpp"
#include "validate/compare/page_parts.hpp"
#include "validate/report/figures.hpp"
#include "validate/system/system.hpp"
#include "validate/thresholds/list.hpp"

namespace swingbank::validate::system {
namespace {

using nlohmann::json;

/// Error map with one row per channel and window; of several terminals, each bin shows the worst.
report::Table terminals_map(const std::vector<compare::EventComparison>& terminals) {
  const auto maps = compare::maps_of(terminals);
  return terminals.size() > 1 ? compare::worst_map_table(maps, "terminal")
                              : compare::map_table(maps, "terminal");
}

/// Table of RMS and largest error of every channel over the whole record.
report::Table summary(const std::vector<compare::EventComparison>& terminals) {
  report::Table table{"Residual (modelled − measured) over the whole record.",
                      {"terminal", "channel", "RMS", "largest", "at", "noise σ", "RMS / noise"},
                      {}};
  for (const auto& e : terminals)
    for (const auto& c : e.channels) {
      const auto in_units = [&](double v) { return fmt::format("{:.3g} {}", v * c.scale, c.unit); };
      table.rows.push_back({e.record.name, c.name, in_units(c.whole.rms), in_units(c.whole.worst),
                            fmt::format("{:.3f} s", c.whole.worst_at),
                            c.noise > 0 ? in_units(c.noise) : "none",
                            report::times_noise(c.whole.in_noise) + (c.map.whole.exceeds() ? " *" : "")});
    }
  return table;
}

std::string place_of(const SystemCase& s, const SystemTerminal& t) {
  return t.plant >= 0 ? "plant " + s.grid.plants[static_cast<std::size_t>(t.plant)].name
                      : fmt::format("bus {}", s.grid.network.buses[static_cast<std::size_t>(t.bus)].number);
}
std::string switching_times_text(const SystemComparison& c) {
  std::string text;
  for (const double t : c.switching_times) text += (text.empty() ? "" : ", ") + fmt::format("{:.4f} s", t);
  return text + (c.uncertainty > 0 ? " (estimated)" : " (given)");
}
std::vector<std::string> event_lines(const sim::grid::EventTexts& t) {
  std::vector<std::string> lines;
  const auto add = [&](const char* what, const std::vector<std::string>& texts) {
    for (const auto& text : texts) lines.push_back(std::string(what) + " " + text);
  };
  add("fault", t.faults);
  add("trip", t.trips);
  add("trip of generator", t.generator_trips);
  add("load step", t.load_steps);
  add("step of Vref", t.vref_steps);
  add("step of Pref", t.pref_steps);
  return lines;
}

/// Table of the differences between model and records before the event.
report::Table initial_table(const SystemCase& s, const SystemComparison& c) {
  report::Table table{
      "Before the event: mean of modelled − measured.", {"terminal", "at", "V", "angle", "P", "Q"}, {}};
  const double scales[] = {1, constants::degrees_in_radian, s.base.mva, s.base.mva};
  const char* units[] = {"pu", "deg", "MW", "Mvar"};
  for (std::size_t i = 0; i < s.terminals.size(); ++i) {
    std::vector<report::Cell> row = {s.terminals[i].name, place_of(s, s.terminals[i])};
    for (std::size_t k = 0; k < 4; ++k) {
      const double v = c.initial[4 * i + k];
      row.emplace_back(std::isfinite(v) ? fmt::format("{:+.4f} {}", v * scales[k], units[k]) : "–");
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

json channel_json(const compare::EventComparison& e, const compare::ChannelComparison& c) {
  return {{"name", c.name},
          {"unit", c.unit},
          {"units_in_pu", c.scale},
          {"noise_pu", c.noise},
          {"rms_pu", c.whole.rms},
          {"mean_pu", c.whole.mean},
          {"worst_pu", c.whole.worst},
          {"worst_at_s", c.whole.worst_at},
          {"map", compare::map_json(e.windows, c.map)}};
}

json terminal_json(const SystemCase& s, const SystemComparison& c, std::size_t i) {
  const SystemTerminal& t = s.terminals[i];
  const compare::EventComparison& e = c.terminals[i];
  json j = {{"name", t.name},
            {"at", place_of(s, t)},
            {"record", t.record.name},
            {"record_sha256", t.record.sha256},
            {"samples", t.record.samples()},
            {"rate_per_s", t.record.rate()},
            {"warnings", t.warnings},
            {"instruments", json::array()},
            {"initial",
             {{"V_pu", c.initial[4 * i]},
              {"angle_rad", c.initial[4 * i + 1]},
              {"P_pu", c.initial[4 * i + 2]},
              {"Q_pu", c.initial[4 * i + 3]}}},
            {"channels", json::array()}};
  for (const auto& block : t.instruments) j["instruments"].push_back(block.effect->name);
  for (const auto& channel : e.channels) j["channels"].push_back(channel_json(e, channel));
  return j;
}

/// Returns the chart of a channel of a terminal; all terminals zoom together.
report::Curves channel_chart(const SystemComparison& c, std::size_t terminal,
                             const compare::ChannelComparison& channel) {
  report::Curves curves = compare::event_chart(c.terminals[terminal], channel.name, channel.unit);
  curves.group = "system";
  curves.fault = {c.switching_times.front(), c.switching_times.back()};
  curves.view = {c.switching_times.front() - 1, c.switching_times.front() + 5};
  curves.id = compare::chart_id(terminal, channel.name);
  curves.series = {{"measured", report::Ink::measured, compare::scaled(channel.measured, channel.scale)},
                   {"modelled", report::Ink::fitted, compare::scaled(channel.modelled, channel.scale)}};
  return curves;
}

/// Returns a chip for each channel of each terminal: its RMS error as a multiple of the noise. The terminals
/// are in the order of the ranking.
report::Chips chips(const SystemCase& s, const SystemComparison& c) {
  report::Chips all;
  for (const auto& r : c.ranking) {
    report::Chips::Group group{s.terminals[r.terminal].name, {}};
    for (const auto& channel : c.terminals[r.terminal].channels) {
      const compare::ChannelError error = compare::channel_error({}, c.terminals[r.terminal], channel);
      group.chips.push_back(
          {channel.name, report::times_noise(channel.whole.in_noise), error.tone,
           compare::chart_id(r.terminal, channel.name),
           fmt::format("RMS error {:.3g} {}", channel.whole.rms * channel.scale, channel.unit)});
    }
    all.groups.push_back(std::move(group));
  }
  return all;
}

void add_terminal(report::Document& page, const SystemCase& s, const SystemComparison& c, std::size_t i) {
  const SystemTerminal& t = s.terminals[i];
  const compare::EventComparison& e = c.terminals[i];
  page.add(report::Begin{report::Begin::Layout::fold, t.name + ", " + place_of(s, t)});
  page.text(fmt::format("{}: {} samples at {:.6g} per second.", t.record.name, t.record.samples(),
                        t.record.rate()));
  for (const auto& note : e.notes) page.note(note);
  page.add(report::Begin{report::Begin::Layout::panels});
  for (const auto& channel : e.channels) {
    report::Curves curves = channel_chart(c, i, channel);
    page.add(curves);
    curves.title = channel.name + " residual (modelled − measured)";
    curves.series = {{"residual", report::Ink::fitted, compare::scaled(channel.residual, channel.scale)}};
    curves.id.clear();
    page.add(std::move(curves));
  }
  page.add(report::End{});
  if (c.terminals.size() > 1) compare::heat_maps(page, terminals_map({e}));
  page.add(report::End{});
}

}  // namespace

report::Table ranking_table(const SystemCase& s, const SystemComparison& c) {
  report::Table table{
      "Terminals, sorted by error. “Alone”: playback of a plant's recorded voltage into its "
      "own model, which excludes errors of the grid and of other plants; plants that fail "
      "alone come first. Numbers: largest ratio of a bin of the error map to its bound; above "
      "1 the error exceeds noise.",
      {"terminal", "at", "in the grid", "largest error", "alone", "largest error, alone"},
      {}};
  for (const auto& r : c.ranking) {
    const auto ratio = [](double worst) {
      return report::Cell(fmt::format("{:.3g}", worst), worst > 1 ? 1.0 : 0.0);
    };
    table.rows.push_back({s.terminals[r.terminal].name, place_of(s, s.terminals[r.terminal]), ratio(r.worst),
                          r.where, r.alone ? ratio(r.alone_worst) : report::Cell("–"),
                          r.alone                 ? r.alone_where
                          : r.alone_where.empty() ? "–"
                                                  : "playback failed"});
  }
  return table;
}

std::string system_text(const SystemCase& s, const SystemComparison& c) {
  std::string out = fmt::format("{}: records compared with the simulation of the whole grid\n\n", s.name);
  out += report::padded(summary(c.terminals));
  out += "\nNormalised RMS per window and band" +
         std::string(c.terminals.size() > 1 ? ", worst of all terminals" : "") + ":\n";
  out += report::padded(terminals_map(c.terminals));
  out += "* = above the joint noise limit\n\nBefore the event, mean of modelled − measured:\n";
  out += report::padded(initial_table(s, c));
  out += "\nTerminals, sorted by error (largest ratio of a bin to its bound):\n";
  out += report::padded(ranking_table(s, c), 6);
  out += "\nswitching at " + switching_times_text(c) + "\n";
  for (const auto& note : c.notes) out += "note: " + note + "\n";
  for (const auto& e : c.terminals)
    for (const auto& note : e.notes) out += "note on " + e.record.name + ": " + note + "\n";
  return out + "\n" + c.adequacy.sentence + "\n" + c.culprit + "\n";
}

std::string system_json(const SystemCase& s, const SystemComparison& c, const report::Provenance& rows) {
  json j = {{"format", "swingbank-system-compare-3"},
            {"name", s.name},
            {"adequate", c.adequacy.adequate},
            {"verdict", c.adequacy.sentence},
            {"adequacy", thresholds::ruling_json(c.adequacy.ruling)},
            {"likely_cause", c.culprit},
            {"bins", c.adequacy.bins},
            {"bins_exceeding", c.adequacy.exceeding},
            {"false_alarm_probability", thresholds::adequacy.false_alarm.value},
            {"event", event_lines(s.texts)},
            {"switching_times_s", c.switching_times},
            {"switching_times_from_records", s.switching_times_from_records},
            {"switching_times_uncertainty_s", c.uncertainty},
            {"outcome", sim::outcome_name(c.outcome)},
            {"reference",
             s.reference < 0 ? json(nullptr) : json(s.terminals[static_cast<std::size_t>(s.reference)].name)},
            {"steady_state", s.steady_state == SteadyState::shift ? "shift" : "judge"},
            {"base_mva", s.base.mva},
            {"frequency_hz", s.base.frequency},
            {"notes", c.notes}};
  j["ranking"] = j["terminals"] = json::array();
  for (const auto& r : c.ranking)
    j["ranking"].push_back({{"terminal", s.terminals[r.terminal].name},
                            {"worst_over_bound", r.worst},
                            {"where", r.where},
                            {"alone_adequate", r.alone ? json(r.alone->adequate) : json(nullptr)},
                            {"alone_worst_over_bound", r.alone ? json(r.alone_worst) : json(nullptr)},
                            {"alone_where", r.alone_where}});
  for (std::size_t i = 0; i < c.terminals.size(); ++i) j["terminals"].push_back(terminal_json(s, c, i));
  for (const auto& [name, value] : rows) j["provenance"].push_back({{"what", name}, {"value", value}});
  return json_text(j, 1) + "\n";
}

std::string system_html(const SystemCase& s, const SystemComparison& c, const report::Provenance& rows) {
  report::Document page{
      "Measured against modelled: " + s.name,
      fmt::format("{} buses, {} plants; the event simulated in the whole grid, compared at {} {}.",
                  s.grid.network.buses.size(), s.grid.plants.size(), s.terminals.size(),
                  s.terminals.size() == 1 ? "terminal" : "terminals")};
  page.add(report::Opening{c.adequacy.adequate ? "Grid model matches: only noise remains"
                                               : "Grid model does not match the records",
                           {c.adequacy.sentence + " " + c.culprit},
                           c.adequacy.adequate ? report::Tone::good : report::Tone::bad});
  page.add(chips(s, c));
  page.note("!: the channel exceeds the noise limit in a bin of its error map; ✓: it exceeds none.");
  if (!c.ranking.empty()) {
    const std::size_t worst = c.ranking.front().terminal;
    page.subsection(s.terminals[worst].name + ", " + place_of(s, s.terminals[worst]));
    page.add(report::Begin{report::Begin::Layout::large});
    for (const auto& channel : c.terminals[worst].channels)
      if (channel.name == "P" || channel.name == "Q") {
        report::Curves curves = channel_chart(c, worst, channel);
        curves.id.clear();
        page.add(std::move(curves));
      }
    page.add(report::End{});
  }
  for (const auto& note : c.notes) page.note(note);
  page.add(ranking_table(s, c));
  page.section("Error map");
  compare::heat_maps(page, terminals_map(c.terminals));
  page.add(summary(c.terminals));
  page.add(initial_table(s, c));
  std::string event;
  for (const auto& line : event_lines(s.texts)) event += (event.empty() ? "" : "; ") + line;
  page.text("Event: " + event + ". Switching: " + switching_times_text(c) + ".");
  page.section("Terminals");
  page.add(report::Paragraph{
      "Drag across a chart to zoom in on a time range (all charts follow); double-click to see the whole record. The "
      "grey band is the fault.",
      report::Paragraph::Kind::hint});
  for (const auto& r : c.ranking) add_terminal(page, s, c, r.terminal);
  page.provenance(rows);
  page.add(report::Data{"figures", system_json(s, c, rows)});
  return report::html(page);
}

report::Provenance system_provenance(const SystemCase& s, const std::string& command_line) {
  const auto hashed = [](const std::filesystem::path& file, const std::string& sha256) {
    return fmt::format("{}, SHA-256 {}", file.string(), sha256);
  };
  report::Provenance rows = {
      {"command", command_line},
      {"software", "swingbank " SWINGBANK_VERSION},
      {"system", hashed(s.file, s.sha256)},
      {"network", hashed(s.raw, s.raw_sha256)},
      {"dynamics", hashed(s.dyr, s.dyr_sha256)},
      {"integrator", fmt::format("IDA on the unreduced grid, relative tolerance {:g}", s.tolerance)}};
  for (const auto& [file, sha256] : s.user_models)
    rows.emplace_back("user-defined model", hashed(file, sha256));
  for (const auto& t : s.terminals)
    rows.emplace_back("record of " + t.name, hashed(t.record.name, t.record.sha256));
  return rows;
}

}  // namespace swingbank::validate::system
