// Statistical verdict: residuals within noise, and sensitivity of the records.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "validate/compare/compare.hpp"
#include "validate/compare/error_map_table.hpp"

namespace swingbank::validate::compare {
namespace {

/// Bin of an error map with its name.
struct NamedCell {
  const EventComparison* event;
  const ChannelComparison* channel;
  std::string where;
  const MapCell* cell;
};
std::vector<NamedCell> all_cells(const std::vector<EventComparison>& events) {
  std::vector<NamedCell> all;
  for (const auto& e : events)
    for (const auto& c : e.channels) {
      if (!c.judged) continue;
      const auto add = [&](const std::string& where, const MapCell& cell) {
        if (!cell.empty()) all.push_back({&e, &c, where, &cell});
      };
      add("over the whole record", c.map.whole);
      for (std::size_t w = 0; w < c.map.rows.size(); ++w) {
        const auto& row = c.map.rows[w];
        add("in the window “" + e.windows[w].name + "”", row.all);
        for (std::size_t b = 0; b < row.bands.size(); ++b)
          add(fmt::format("in the window “{}” at {}", e.windows[w].name, error_bands()[b].name),
              row.bands[b]);
      }
    }
  return all;
}

/// Returns whether noise alone may exceed the channel's nominal value in the bin, so that it has no
/// information.
bool is_uninformative(const NamedCell& named) { return !(named.cell->allowed() <= named.channel->size); }

/// Sentence about the bin with the largest ratio of noise to nominal value.
std::string vague_sentence(const std::vector<NamedCell>& cells, int vague) {
  const auto share = [](const NamedCell& n) { return n.cell->allowed() / n.channel->size; };
  constexpr double kNoSize = 10;  // largest ratio shown as a number; above it the model is clearly unstable
  const NamedCell& most = *std::ranges::max_element(cells, {}, share);
  const std::string by =
      share(most) < kNoSize
          ? fmt::format("{:.3g} {}, {:.3g} times the nominal value",
                        most.cell->allowed() * most.channel->scale, most.channel->unit, share(most))
          : fmt::format("more than {:g} times the nominal value", kNoSize);
  return fmt::format(
      "Undecided: the model is unstable in this playback. In {} of {} time/frequency bins the "
      "voltage noise alone may change the response by more than its nominal value ({} {}: by "
      "{}). Check the damping, the time constants and the order of the reactances.",
      vague, cells.size(), most.channel->name, most.where, by);
}

}  // namespace

Adequacy judge(std::vector<EventComparison>& events) {
  std::vector<ErrorMap*> maps;
  for (auto& e : events)
    for (auto& c : e.channels)
      if (c.judged) maps.push_back(&c.map);
  set_bounds(maps, thresholds::adequacy.false_alarm);
  Adequacy a;
  const NamedCell* worst = nullptr;
  const auto cells = all_cells(events);
  for (const auto& named : cells) {
    ++a.cells;
    a.exceeding += named.cell->exceeds() ? 1 : 0;
    a.vague += is_uninformative(named) ? 1 : 0;
    if (!worst || named.cell->normalised / named.cell->bound > worst->cell->normalised / worst->cell->bound)
      worst = &named;
  }
  a.ruling = thresholds::judged_by_cells(a.exceeding + a.vague, a.cells);
  a.adequate = a.ruling.adequate;
  if (a.vague > 0) {
    a.sentence = vague_sentence(cells, a.vague);
    return a;
  }
  a.sentence =
      a.adequate ? fmt::format("Adequate: each of {} time/frequency bins is within the noise limit", a.cells)
                 : fmt::format("Not adequate: {} of {} time/frequency bins exceed the noise limit",
                               a.exceeding, a.cells);
  a.sentence += fmt::format(" (joint {:g} % level).", 100 * (1 - thresholds::adequacy.false_alarm));
  if (worst)
    a.sentence += fmt::format(" {}: {} {} of {}, RMS {:.3g} {}, normalised RMS {} where {} is allowed.",
                              a.adequate ? "Nearest to its bound" : "Largest violation", worst->channel->name,
                              worst->where, worst->event->record.name,
                              worst->cell->rms * worst->channel->scale, worst->channel->unit,
                              times_noise(worst->cell->normalised), times_noise(worst->cell->bound));
  return a;
}

}  // namespace swingbank::validate::compare
