// Statistical verdict: whether the residuals are within noise, and whether the records can decide it.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "validate/compare/compare.hpp"
#include "validate/compare/error_map_table.hpp"
#include "validate/report/figures.hpp"

namespace swingbank::validate::compare {
namespace {

/// Bin of an error map with its name.
struct NamedBin {
  const EventComparison* event;
  const ChannelComparison* channel;
  std::string where;
  const TimeFrequencyBin* bin;
};
std::vector<NamedBin> all_bins(const std::vector<EventComparison>& events) {
  std::vector<NamedBin> all;
  for (const auto& e : events)
    for (const auto& c : e.channels) {
      if (!c.judged) continue;
      const auto add = [&](const std::string& where, const TimeFrequencyBin& bin) {
        if (!bin.empty()) all.push_back({&e, &c, where, &bin});
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

/// Returns whether noise alone may exceed the channel's nominal value in the bin. The bin then has no
/// information.
bool is_uninformative(const NamedBin& named) { return !(named.bin->allowed() <= named.channel->size); }

/// Sentence about the bin with the largest ratio of noise to nominal value.
std::string vague_sentence(const std::vector<NamedBin>& bins, int vague) {
  const auto share = [](const NamedBin& n) { return n.bin->allowed() / n.channel->size; };
  constexpr double kNoSize = 10;  // largest ratio shown as a number; above it the model is clearly unstable
  const NamedBin& most = *std::ranges::max_element(bins, {}, share);
  const std::string by =
      share(most) < kNoSize
          ? fmt::format("{:.3g} {}, {:.3g} times the nominal value",
                        most.bin->allowed() * most.channel->scale, most.channel->unit, share(most))
          : fmt::format("more than {:g} times the nominal value", kNoSize);
  return fmt::format(
      "Undecided: the model is unstable in this playback. In {} of {} time/frequency bins the "
      "noise of the played-in signals alone may change the response by more than its nominal value ({} {}: by "
      "{}). Check the damping, the time constants and the order of the reactances.",
      vague, bins.size(), most.channel->name, most.where, by);
}

}  // namespace

Adequacy judge(std::vector<EventComparison>& events) {
  std::vector<ErrorMap*> maps;
  for (auto& e : events)
    for (auto& c : e.channels)
      if (c.judged) maps.push_back(&c.map);
  set_bounds(maps, thresholds::adequacy.false_alarm);
  Adequacy a;
  int failing = 0;  // bins that exceed their bound or are uninformative
  const NamedBin* worst = nullptr;
  const auto bins = all_bins(events);
  for (const auto& named : bins) {
    ++a.bins;
    a.exceeding += named.bin->exceeds() ? 1 : 0;
    a.vague += is_uninformative(named) ? 1 : 0;
    failing += named.bin->exceeds() || is_uninformative(named) ? 1 : 0;
    if (!worst || named.bin->normalised / named.bin->bound > worst->bin->normalised / worst->bin->bound)
      worst = &named;
  }
  a.ruling = thresholds::judged_by_bins(failing, a.bins);
  a.adequate = a.ruling.adequate;
  if (a.vague > 0) {
    a.sentence = vague_sentence(bins, a.vague);
    return a;
  }
  a.sentence = a.adequate
                   ? fmt::format("Adequate: each of {} time/frequency bins is within the noise limit", a.bins)
                   : fmt::format("Not adequate: {} of {} time/frequency bins exceed the noise limit",
                                 a.exceeding, a.bins);
  a.sentence += fmt::format(" (joint {:g} % level).", 100 * (1 - thresholds::adequacy.false_alarm));
  if (worst)
    a.sentence += fmt::format(
        " {}: {} {} of {}, RMS {:.3g} {}, normalised RMS {} (limit {}).",
        a.adequate ? "Nearest to its bound" : "Largest violation", worst->channel->name, worst->where,
        worst->event->record.name, worst->bin->rms * worst->channel->scale, worst->channel->unit,
        report::ratio_text(worst->bin->normalised), report::ratio_text(worst->bin->bound));
  return a;
}

}  // namespace swingbank::validate::compare
