#include "validate/compare_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace swingbank::validate {
namespace {

double scale(const EventComparison& e) { return e.record.base.mva; }

std::string ratio_text(double in_noise) {
  if (!std::isfinite(in_noise)) return "–";
  return in_noise < 9.95 ? fmt::format("{:.1f} ×", in_noise) : fmt::format("{:.0f} ×", in_noise);
}

/// 1 × noise is as good as it gets (0), 30 × is beyond dispute (1); logarithmic between.
double shade(double in_noise) {
  return std::isfinite(in_noise) ? std::clamp(std::log(in_noise / 1.2) / std::log(25.0), 0.0, 1.0) : -1;
}

/// Every window name that occurs, in order of time.
std::vector<std::string> window_names(const std::vector<EventComparison>& events) {
  std::vector<std::string> names;
  for (const char* name : {"pre-event", "fault", "0–1 s after", "1–5 s after", "> 5 s after"})
    for (const auto& e : events)
      if (std::ranges::find(e.windows, name, &Window::name) != e.windows.end()) {
        names.emplace_back(name);
        break;
      }
  return names;
}

const WindowError* find_window(const EventComparison& e, const ChannelComparison& c,
                               const std::string& name) {
  const auto w = std::ranges::find(e.windows, name, &Window::name);
  return w == e.windows.end() ? nullptr : &c.windows[static_cast<std::size_t>(w - e.windows.begin())];
}

std::string describe_instants(const EventComparison& e) {
  if (e.switchings.empty()) return "none";
  std::string text;
  for (const auto& s : e.switchings) text += (text.empty() ? "" : ", ") + fmt::format("{:.4f} s", s.time);
  return text + (!e.detected ? " (given)" : e.fitted ? " (found and fitted)" : " (found)");
}

std::vector<std::pair<double, double>> fault_bands(const EventComparison& e) {
  if (e.switchings.empty()) return {};
  return {{e.switchings.front().time, e.switchings.back().time}};
}

void add_event(Page& page, const EventComparison& e) {
  page.section(e.record.name);
  page.text(fmt::format(
      "{} samples at {:.6g} per second. Switching: {}. Start: P = {:.2f} MW, Q = {:.2f} Mvar, V = {:.4f} pu.",
      e.record.samples(), e.record.rate(), describe_instants(e), e.playback.start.P * scale(e),
      e.playback.start.Q * scale(e), std::abs(e.playback.start.voltage)));
  for (const auto& note : e.notes) page.note(note);
  const auto in_units = [&](std::vector<double> v) {
    for (auto& x : v) x *= scale(e);
    return v;
  };
  for (const auto& c : e.channels) {
    Curves overlay{c.name + ", measured and modelled",
                   "t [s]",
                   c.name + " [" + c.unit + "]",
                   e.record.name,
                   e.record.t,
                   {},
                   fault_bands(e)};
    overlay.series.push_back({c.name + " measured", "#8a97a5", true, in_units(c.measured)});
    overlay.series.push_back({c.name + " modelled", "#c0392b", false, in_units(c.modelled)});
    page.curves(overlay);
    Curves residual{c.name + " residual (modelled − measured)",
                    "t [s]",
                    "[" + c.unit + "]",
                    e.record.name,
                    e.record.t,
                    {},
                    fault_bands(e)};
    residual.series.push_back({c.name + " residual", "#0b5cad", false, in_units(c.residual)});
    page.curves(residual);
  }
}

nlohmann::json to_json(const WindowError& w) {
  nlohmann::json j = {{"samples", w.samples},
                      {"rms_pu", w.rms},
                      {"mean_pu", w.mean},
                      {"worst_pu", w.worst},
                      {"worst_at_s", w.worst_at}};
  j["rms_in_noise"] = std::isfinite(w.in_noise) ? nlohmann::json(w.in_noise) : nlohmann::json(nullptr);
  return j;
}

nlohmann::json to_json(const EventComparison& e) {
  nlohmann::json j = {{"record", e.record.name},
                      {"record_xxh64", fmt::format("{:016x}", e.record.hash)},
                      {"samples", e.record.samples()},
                      {"rate_per_s", e.record.rate()},
                      {"switchings_found", e.detected},
                      {"switchings_fitted", e.fitted},
                      {"start",
                       {{"P_pu", e.playback.start.P},
                        {"Q_pu", e.playback.start.Q},
                        {"V_pu", std::abs(e.playback.start.voltage)}}},
                      {"notes", e.notes}};
  j["switchings"] = j["channels"] = nlohmann::json::array();
  for (const auto& s : e.switchings)
    j["switchings"].push_back({{"t_s", s.time}, {"uncertainty_s", s.uncertainty}});
  for (const auto& c : e.channels) {
    nlohmann::json channel = {{"name", c.name}, {"noise_pu", c.noise}, {"whole", to_json(c.whole)}};
    channel["windows"] = nlohmann::json::array();
    for (std::size_t w = 0; w < e.windows.size(); ++w) {
      auto window = to_json(c.windows[w]);
      window["name"] = e.windows[w].name;
      window["from_s"] = e.windows[w].from;
      window["to_s"] = e.windows[w].to;
      channel["windows"].push_back(window);
    }
    j["channels"].push_back(channel);
  }
  return j;
}

/// The window in which the model is furthest off, in words.
std::string finding(const std::vector<EventComparison>& events) {
  const EventComparison* event = nullptr;
  const ChannelComparison* channel = nullptr;
  std::size_t window = 0;
  for (const auto& e : events)
    for (const auto& c : e.channels)
      for (std::size_t w = 0; w < c.windows.size(); ++w)
        if (std::isfinite(c.windows[w].in_noise) &&
            (!channel || c.windows[w].in_noise > channel->windows[window].in_noise))
          event = &e, channel = &c, window = w;
  if (!channel) return {};
  const auto& w = channel->windows[window];
  return fmt::format("Furthest off: {} in the window “{}” of {}, RMS {:.3g} {}, {} the noise.", channel->name,
                     event->windows[window].name, event->record.name, w.rms * scale(*event), channel->unit,
                     ratio_text(w.in_noise));
}

/// Columns padded to the same width; counts characters, not bytes.
std::string padded(const Table& table) {
  const auto length = [](const std::string& s) {
    return std::ranges::count_if(s, [](unsigned char c) { return (c & 0xC0) != 0x80; });
  };
  std::vector<std::ptrdiff_t> width;
  for (const auto& h : table.header) width.push_back(length(h));
  for (const auto& row : table.rows)
    for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], length(row[i].text));
  std::string out;
  const auto line = [&](const auto& row, const auto& text) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string pad(static_cast<std::size_t>(width[i] - length(text(row[i]))), ' ');
      out += i < 2 ? text(row[i]) + pad + "  " : pad + text(row[i]) + "  ";
    }
    out.erase(out.find_last_not_of(' ') + 1);
    out += "\n";
  };
  line(table.header, [](const std::string& s) { return s; });
  for (const auto& row : table.rows) line(row, [](const Cell& c) { return c.text; });
  return out;
}

}  // namespace

Table error_summary(const std::vector<EventComparison>& events) {
  Table table{"Residual (modelled − measured) over the whole record.",
              {"event", "channel", "RMS", "RMS [pu]", "largest", "at", "noise σ", "RMS / noise"},
              {}};
  for (const auto& e : events)
    for (const auto& c : e.channels)
      table.rows.push_back({e.record.name, c.name, fmt::format("{:.3f} {}", c.whole.rms * scale(e), c.unit),
                            fmt::format("{:.5f}", c.whole.rms),
                            fmt::format("{:.3f} {}", c.whole.worst * scale(e), c.unit),
                            fmt::format("{:.3f} s", c.whole.worst_at),
                            c.noise > 0 ? fmt::format("{:.3f} {}", c.noise * scale(e), c.unit) : "none",
                            Cell(ratio_text(c.whole.in_noise), shade(c.whole.in_noise))});
  return table;
}

Table error_map(const std::vector<EventComparison>& events) {
  Table table{
      "RMS of the residual in each window, and how many times the noise that is. Noise is the spread of the "
      "pre-event residual; "
      "about 1 × means that nothing but noise is left.",
      {"event", "channel"},
      {}};
  const auto names = window_names(events);
  table.header.insert(table.header.end(), names.begin(), names.end());
  for (const auto& e : events)
    for (const auto& c : e.channels) {
      std::vector<Cell> row = {e.record.name, c.name};
      for (const auto& name : names) {
        const auto* w = find_window(e, c, name);
        if (!w)
          row.emplace_back("–");
        else
          row.emplace_back(fmt::format("{:.3g} {} · {}", w->rms * scale(e), c.unit, ratio_text(w->in_noise)),
                           shade(w->in_noise));
      }
      table.rows.push_back(std::move(row));
    }
  return table;
}

std::string terminal_report(const PlantModel& model, const std::vector<EventComparison>& events) {
  std::string out =
      fmt::format("{} ({}): measured against modelled\n\n", model.name, model.plant.machine.effect->name);
  out += padded(error_summary(events)) + "\nRMS per window, and in units of the noise:\n" +
         padded(error_map(events)) + "\n" + finding(events) + "\n";
  for (const auto& e : events) {
    out += fmt::format("\n{}: switching at {}\n", e.record.name, describe_instants(e));
    for (const auto& note : e.notes) out += "  note: " + note + "\n";
  }
  return out;
}

std::string json_report(const PlantModel& model, const std::vector<EventComparison>& events,
                        const Provenance& rows) {
  nlohmann::json j = {{"format", "swingbank-compare-1"},
                      {"model",
                       {{"name", model.name},
                        {"file", model.origin},
                        {"xxh64", fmt::format("{:016x}", model.hash)},
                        {"mva", model.plant.mva}}},
                      {"base_mva", model.record_base.mva},
                      {"frequency_hz", model.record_base.frequency}};
  j["events"] = nlohmann::json::array();
  for (const auto& e : events) j["events"].push_back(to_json(e));
  for (const auto& [name, value] : rows) j["provenance"][name] = value;
  return j.dump(2) + "\n";
}

std::string csv_playback(const EventComparison& e) {
  std::string out = "t_s,V_pu,theta_rad,P_measured_pu,P_modelled_pu,Q_measured_pu,Q_modelled_pu\n";
  for (std::size_t k = 0; k < e.record.t.size(); ++k)
    out += fmt::format("{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", e.record.t[k], e.record.V[k],
                       e.record.theta[k], e.record.P[k], e.playback.P[k], e.record.Q[k], e.playback.Q[k]);
  return out;
}

std::string html_report(const PlantModel& model, const std::vector<EventComparison>& events,
                        const Provenance& rows) {
  Page page("Measured against modelled: " + model.name,
            fmt::format("{} of {:g} MVA; the recorded terminal voltage is played into the model, and the P "
                        "and Q it answers with are compared.",
                        model.plant.machine.effect->name, model.plant.mva));
  page.text(finding(events));
  page.table(error_map(events));
  page.table(error_summary(events));
  page.text(
      "Drag across a chart to zoom in on a stretch of time (all charts of an event follow); double-click to "
      "see the whole record. The shaded band is the fault.");
  for (const auto& e : events) add_event(page, e);
  page.provenance(rows);
  return page.html();
}

Provenance provenance(const PlantModel& model, const std::vector<EventComparison>& events,
                      const std::string& command_line) {
  Provenance rows = {{"command", command_line},
                     {"software", "swingbank " SWINGBANK_VERSION},
                     {"model", fmt::format("{}, XXH64 {:016x}", model.origin, model.hash)}};
  rows.emplace_back(
      "conventions",
      fmt::format(
          "{}; {}; {:g} Hz",
          model.conventions.speed_voltage ? "speed in the stator voltage" : "no speed in the stator voltage",
          model.conventions.mechanical_power ? "mechanical power held" : "mechanical torque held",
          model.conventions.frequency));
  for (const auto& e : events)
    rows.emplace_back("record", fmt::format("{}, XXH64 {:016x}", e.record.name, e.record.hash));
  return rows;
}

}  // namespace swingbank::validate
