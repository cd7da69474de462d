#include "validate/compare/error_map_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/json.hpp"
#include "validate/compare/compare.hpp"
#include "validate/report/figures.hpp"

namespace swingbank::validate::compare {
namespace {

/// Returns the shade of a bin: -1 without a bound, 0 within its bound, 0.35 just above it, rising
/// logarithmically to 1 at 25 times the bound.
double shade(const TimeFrequencyBin& bin) {
  if (bin.empty() || !std::isfinite(bin.bound)) return -1;
  if (!bin.exceeds()) return 0;
  return std::clamp(0.35 + 0.65 * std::log(bin.normalised / bin.bound) / std::log(25.0), 0.0, 1.0);
}

/// Returns a percentage as text, from 10 on as an integer without an exponent.
std::string percent_text(double percent) {
  return percent < 10 ? fmt::format("{:.2g}", percent) : fmt::format("{:.0f}", percent);
}
/// Returns the nominal value of the channel, "100 MVA" or "60 Hz".
std::string nominal_text(const LabelledMap& m) {
  const double nominal = m.size * m.scale;
  if (m.unit == "mHz") return fmt::format("{:.4g} Hz", nominal / 1e3);
  return fmt::format("{:.4g} {}", nominal, m.unit == "MW" || m.unit == "Mvar" ? "MVA" : m.unit);
}

/// Returns a cell of the map. Its tooltip shows the error in the channel's unit, in % of the nominal value,
/// and against the bound.
report::Cell map_cell(const LabelledMap& m, const std::string& window, std::string_view band,
                      const TimeFrequencyBin& bin) {
  if (bin.empty()) return {"–"};
  report::Cell cell(report::times_noise(bin.normalised) + (bin.exceeds() ? " *" : ""), shade(bin));
  const double error = bin.rms * m.scale;
  cell.hint =
      fmt::format("{} of {}, {}, {}: RMS {:.3g} {}", m.channel == "speed" ? "speed deviation" : m.channel,
                  m.event, window, band, error, m.unit);
  if (m.size > 0)
    cell.hint += fmt::format(", {} % of {}", percent_text(100 * bin.rms / m.size), nominal_text(m));
  cell.hint += fmt::format("; normalised RMS {} (limit {})", report::ratio_text(bin.normalised),
                           report::ratio_text(bin.bound));
  return cell;
}

/// `event`: heading of the column of the events; empty: no such column.
std::vector<std::string> columns(const std::string& event) {
  std::vector<std::string> names;
  if (!event.empty()) names.push_back(event);
  for (const char* name : {"channel", "window", "RMS", "all"}) names.emplace_back(name);
  for (const Band& band : error_bands()) names.emplace_back(band.name);
  return names;
}

/// Bin in a row of the table, with the event and channel that it comes from.
struct MapRow {
  const TimeFrequencyBin* bin = nullptr;
  const LabelledMap* of = nullptr;
};
void add_row(report::Table& table, const LabelledMap& m, const std::string& window,
             const std::vector<MapRow>& row, bool with_event) {
  std::vector<report::Cell> cells;
  if (with_event) cells.emplace_back(m.event);
  cells.emplace_back(m.channel);
  cells.emplace_back(window);
  const MapRow& all = row.front();
  cells.emplace_back(!all.bin || all.bin->empty() ? "–"
                                                  : fmt::format("{:.3g} {}", all.bin->rms * m.scale, m.unit));
  for (std::size_t k = 0; k < row.size(); ++k)
    cells.push_back(row[k].bin ? map_cell(*row[k].of, window,
                                          k ? error_bands()[k - 1].name : "all frequencies", *row[k].bin)
                               : report::Cell("–"));
  table.rows.push_back(std::move(cells));
}

/// Returns the bins of a window: all frequencies, then the bands.
std::vector<MapRow> bins_of(const LabelledMap& m, std::size_t window) {
  std::vector<MapRow> row = {{&m.map->rows[window].all, &m}};
  for (const TimeFrequencyBin& bin : m.map->rows[window].bands) row.push_back({&bin, &m});
  return row;
}
void keep_worse(std::vector<MapRow>& worst, const std::vector<MapRow>& row) {
  if (worst.empty()) worst.resize(row.size());
  const auto ratio = [](const MapRow& r) { return r.bin->normalised / r.bin->bound; };
  for (std::size_t k = 0; k < row.size(); ++k)
    if (!row[k].bin->empty() && (!worst[k].bin || ratio(row[k]) > ratio(worst[k]))) worst[k] = row[k];
}

/// Returns " This bin exceeds its limit in n of m events.", where m is the number of events that have the
/// bin; empty if m is 1.
std::string events_beyond(const std::vector<LabelledMap>& maps, const std::string& channel,
                          const std::string& window, std::size_t band) {
  int beyond = 0, all = 0;
  for (const auto& m : maps)
    for (std::size_t w = 0; w < m.windows->size(); ++w) {
      if (m.channel != channel || (*m.windows)[w].name != window || m.map->rows[w].bands[band].empty())
        continue;
      ++all;
      beyond += m.map->rows[w].bands[band].exceeds() ? 1 : 0;
    }
  return all > 1 ? fmt::format(" This bin exceeds its limit in {} of {} events.", beyond, all) : "";
}

constexpr const char* kCaption =
    "Normalised RMS of the residual per time window and frequency band: each component is "
    "divided by its standard deviation under coloured noise, so that noise alone gives 1 ×. "
    "“After”: time since the last switching. “Fault”: first to last switching. “Pre-event”: before the first "
    "switching. * = above the joint noise limit of all bins; “–”: the window is too short for the band.";

}  // namespace

std::vector<LabelledMap> maps_of(const std::vector<EventComparison>& events) {
  std::vector<LabelledMap> maps;
  for (const auto& e : events)
    for (const auto& c : e.channels)
      maps.push_back({e.record.name, c.name, c.unit, c.scale, &e.windows, &c.map, c.size});
  return maps;
}

report::Table map_table(const std::vector<LabelledMap>& maps, const std::string& subject) {
  std::set<std::string> events;
  for (const auto& m : maps) events.insert(m.event);
  const bool with_event = events.size() > 1;
  report::Table table{kCaption, columns(with_event ? subject : ""), {}};
  for (const auto& m : maps)
    for (std::size_t w = 0; w < m.windows->size(); ++w)
      add_row(table, m, (*m.windows)[w].name, bins_of(m, w), with_event);
  return table;
}

report::Table worst_map_table(const std::vector<LabelledMap>& maps, const std::string& subject) {
  report::Table table{
      fmt::format("{} Each bin shows the worst of all {}s.", kCaption, subject), columns(""), {}};
  std::vector<std::string> channels;
  for (const auto& m : maps)
    if (std::ranges::find(channels, m.channel) == channels.end()) channels.push_back(m.channel);
  std::vector<std::string> windows = {"pre-event", "fault", "0–1 s after", "1–5 s after", "> 5 s after"};
  for (const auto& m : maps)
    for (const Window& w : *m.windows)  // records without a switching have other window names
      if (std::ranges::find(windows, w.name) == windows.end()) windows.push_back(w.name);
  for (const auto& channel : channels)
    for (const auto& window : windows) {
      std::vector<MapRow> worst;
      const LabelledMap* of = nullptr;
      for (const auto& m : maps)
        for (std::size_t w = 0; w < m.windows->size(); ++w) {
          if (m.channel != channel || (*m.windows)[w].name != window) continue;
          of = &m;
          keep_worse(worst, bins_of(m, w));
        }
      if (of) add_row(table, *of, window, worst, false);
    }
  return table;
}

std::string map_sentence(const std::vector<LabelledMap>& maps) {
  std::vector<std::string> channels;
  for (const auto& m : maps)
    if (std::ranges::find(channels, m.channel) == channels.end()) channels.push_back(m.channel);
  std::string text;
  for (const auto& channel : channels) {
    TimeFrequencyBin worst;
    std::string window;
    std::size_t band = 0;
    for (const auto& m : maps)
      for (std::size_t w = 0; m.channel == channel && w < m.windows->size(); ++w)
        for (std::size_t b = 0; b < m.map->rows[w].bands.size(); ++b) {
          const TimeFrequencyBin& bin = m.map->rows[w].bands[b];
          if (!bin.exceeds() ||
              (!worst.empty() && bin.normalised / bin.bound <= worst.normalised / worst.bound))
            continue;
          worst = bin;
          window = (*m.windows)[w].name;
          band = b;
        }
    text += text.empty() ? "" : " ";
    text +=
        worst.empty()
            ? channel + ": all bins are within their noise limits."
            : fmt::format(
                  "{}: largest exceedance of a noise limit in the window {}{}, band {}: normalised RMS {} (limit "
                  "{}).{}",
                  channel, window, window.ends_with(" after") ? " the last switching" : "",
                  error_bands()[band].name, report::ratio_text(worst.normalised),
                  report::ratio_text(worst.bound), events_beyond(maps, channel, window, band));
  }
  return text;
}

nlohmann::json map_json(const std::vector<Window>& windows, const ErrorMap& map) {
  auto rows = nlohmann::json::array();
  const auto add = [&](const std::string& window, std::string_view band, const TimeFrequencyBin& bin) {
    nlohmann::json j = {{"window", window}, {"band", band}, {"values", bin.values}};
    const auto number = [&](double v) { return bin.empty() ? nlohmann::json(nullptr) : nlohmann::json(v); };
    j["rms_pu"] = number(bin.rms);
    j["normalised_rms"] = number(bin.normalised);
    j["normalised_bound"] = number(bin.bound);
    rows.push_back(std::move(j));
  };
  for (std::size_t w = 0; w < windows.size(); ++w) {
    add(windows[w].name, "all", map.rows[w].all);
    for (std::size_t b = 0; b < map.rows[w].bands.size(); ++b)
      add(windows[w].name, error_bands()[b].name, map.rows[w].bands[b]);
  }
  add("whole record", "all", map.whole);
  return rows;
}

}  // namespace swingbank::validate::compare
