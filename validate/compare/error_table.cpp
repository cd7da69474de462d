#include "validate/compare/error_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/json.hpp"
#include "validate/compare/error_map_table.hpp"
#include "validate/report/figures.hpp"

namespace swingbank::validate::compare {
namespace {

constexpr const char* kErrorCaption =
    "Residual (modelled − measured) over the whole record. Noise σ: standard deviation of the residual before "
    "the event. RMS / noise: ratio of the two. Maximum error: largest "
    "absolute value, with its time. A star marks a channel whose normalised RMS exceeds its bound "
    "(error map).";

std::string quantity(double value, const ChannelComparison& c) {
  return fmt::format("{:.4g} {}", value * c.scale, c.unit);
}

void add_cells(std::vector<report::Cell>& row, const ChannelComparison* c) {
  if (!c) {
    row.insert(row.end(), 3, report::Cell("–"));
    return;
  }
  row.emplace_back(quantity(c->whole.rms, *c));
  row.emplace_back(c->noise > 0 ? quantity(c->noise, *c) : "none");
  row.emplace_back(report::times_noise(c->whole.in_noise) + (c->map.whole.exceeds() ? " *" : ""));
}

}  // namespace

report::Table error_table(const std::vector<Played>& played, const EventUse& use) {
  report::Table table{kErrorCaption, {"event", "channel"}, {}};
  if (use.fitted) table.header.emplace_back("use");
  const bool single = played.size() == 1;
  for (const Played& p : played)
    for (const char* what : {"RMS", "noise σ", "RMS / noise"})
      table.header.push_back(single ? what : fmt::format("{}, {}", what, p.name));
  if (single) table.header.insert(table.header.end(), {"maximum error", "at"});
  const auto longest = std::ranges::max_element(played, {}, [](const Played& p) { return p.events.size(); });
  if (longest == played.end()) return table;
  for (std::size_t e = 0; e < longest->events.size(); ++e) {
    const EventComparison& event = longest->events[e];
    for (const ChannelComparison& c : event.channels) {
      std::vector<report::Cell> row = {event.record.name, c.name};
      if (use.fitted) row.emplace_back(use.of(event.record.name));
      for (const Played& p : played) add_cells(row, find_channel(&p, e, c.name));
      if (single) {
        row.emplace_back(quantity(c.whole.worst, c));
        row.emplace_back(fmt::format("{:.3f} s", c.whole.worst_at));
      }
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

std::string error_text(const std::vector<Played>& played, const EventUse& use) {
  const report::Table table = error_table(played, use);
  return table.caption + "\n" + report::padded(table, use.fitted ? 3 : 2);
}

nlohmann::json errors_json(const std::vector<Played>& played) {
  nlohmann::json rows = nlohmann::json::array();
  for (const Played& p : played)
    for (const EventComparison& e : p.events)
      for (const ChannelComparison& c : e.channels)
        rows.push_back({{"record", e.record.name},
                        {"channel", c.name},
                        {"model", p.name},
                        {"unit", c.unit},
                        {"rms", c.whole.rms * c.scale},
                        {"noise", c.noise * c.scale},
                        {"rms_over_noise", c.whole.in_noise}});
  return rows;
}

}  // namespace swingbank::validate::compare
