#include "validate/compare/first_screen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "validate/compare/error_map_table.hpp"
#include "validate/compare/event_title.hpp"
#include "validate/report/figures.hpp"

namespace swingbank::validate::compare {
namespace {

constexpr double kShownBefore = 1,
                 kShownAfter = 5;  ///< initial view before and after the first switching [s]

/// Returns "86 → 1.0 ×", or "86 ×" for one model.
std::string fall_text(const ChannelComparison& before, const ChannelComparison* after) {
  std::string text = report::times_noise(before.whole.in_noise);
  if (!after) return text;
  if (text.ends_with(" ×")) text.erase(text.size() - std::string(" ×").size());
  return text + " → " + report::times_noise(after->whole.in_noise);
}

std::string event_label(const FirstScreen& s, std::size_t event) {
  if (!s.use.fitted) return fmt::format("event {}", event + 1);
  return fmt::format("event {} ({})", event + 1, s.use.of(s.before->events[event].record.name));
}

report::Chips::Chip chip(const FirstScreen& s, std::size_t event, const ChannelComparison& c) {
  const ChannelComparison* after = find_channel(s.after, event, c.name);
  const bool by_after = after != nullptr && !s.judge_before;
  const Played& judged = by_after ? *s.after : *s.before;
  const ChannelError error = channel_error(judged.fitness, judged.events[event], by_after ? *after : c);
  const auto rms = [](const ChannelComparison& of) { return fmt::format("{:.4g}", of.whole.rms * of.scale); };
  return {c.name, fall_text(c, after), error.tone, chart_id(event, c.name),
          fmt::format("{} {}: RMS error {}{} {}, in multiples of the noise {}{}",
                      s.before->events[event].record.name, c.name, rms(c), after ? " → " + rms(*after) : "",
                      c.unit, fall_text(c, after),
                      error.limit > 0 ? fmt::format("; {:.0f} % of its limit", 100 * error.limit) : "")};
}

report::Chips chips(const FirstScreen& s) {
  report::Chips all;
  for (std::size_t e = 0; e < s.before->events.size(); ++e) {
    report::Chips::Group group{event_label(s, e), {}};
    for (const auto& c : s.before->events[e].channels)
      if (c.judged) group.chips.push_back(chip(s, e, c));
    all.groups.push_back(std::move(group));
  }
  return all;
}

/// Returns the meaning of the marks and numbers of the chips, and the model that they judge.
std::string marks_text(const FirstScreen& s) {
  const Played& judged = s.after && !s.judge_before ? *s.after : *s.before;
  return fmt::format(
      "RMS error in multiples of the noise{}. Marks ({}): ✕ exceeds an engineering limit; ! exceeds "
      "only the noise limit of a bin; ✓ within both.",
      s.after ? fmt::format(", {} → {}", s.before->name, s.after->name) : "", judged.name);
}

/// Returns the bars of each event's worst channel before and after the change of the model.
report::Bars fall(const FirstScreen& s) {
  report::Bars bars{fmt::format("RMS error in multiples of the noise, worst channel of each event: {} → {}",
                                s.before->name, s.after->name),
                    "",
                    1,
                    "noise",
                    {}};
  for (std::size_t e = 0; e < s.before->events.size(); ++e) {
    const ChannelComparison* worst = nullptr;
    for (const auto& c : s.before->events[e].channels)
      if (c.judged && std::isfinite(c.whole.in_noise) && (!worst || c.whole.in_noise > worst->whole.in_noise))
        worst = &c;
    const ChannelComparison* after = worst ? find_channel(s.after, e, worst->name) : nullptr;
    if (!after) continue;
    bars.bars.push_back({event_label(s, e) + " " + worst->name, worst->whole.in_noise, "before",
                         report::times_noise(worst->whole.in_noise)});
    bars.bars.push_back({"", after->whole.in_noise, "after", report::times_noise(after->whole.in_noise)});
  }
  return bars;
}

/// Shades the window in which the channel is furthest above its noise bound, and extends the view so that
/// this window is visible.
void shade_worst(report::Curves& c, const FirstScreen& s, std::size_t event, const std::string& name) {
  const EventComparison& of = s.before->events[event];
  const ChannelError error = channel_error(s.before->fitness, of, *find_channel(s.before, event, name));
  if (error.tone == report::Tone::good || error.window < 0) return;
  const Window& w = of.windows[static_cast<std::size_t>(error.window)];
  c.window = {w.from, w.to};
  if (c.view && w.from >= c.view->second) c.view->second = std::min(w.to, of.record.t.back());
}

/// Adds the worst event with P and Q side by side.
void large_charts(report::Document& document, const FirstScreen& s) {
  const auto [event, channels] = worst_event(*s.before);
  std::vector<report::Curves> charts;
  const EventComparison& last = (s.after ? s.after : s.before)->events[event];
  document.subsection(fmt::format("Event {}: {}, {}", event + 1, last.record.name, event_title(last)));
  for (const auto& name : channels) {
    charts.push_back(channel_curves(
        {{s.before, s.after ? report::Ink::submitted : report::Ink::fitted}, {s.after, report::Ink::fitted}},
        event, name));
    shade_worst(charts.back(), s, event, name);
  }
  const auto widest = std::ranges::max_element(
      charts, {}, [](const report::Curves& c) { return c.view ? c.view->second : 0; });
  document.add(report::Begin{report::Begin::Layout::large});
  for (auto& c : charts) {
    c.view = widest->view;
    document.add(c);
  }
  document.add(report::End{});
}

/// Returns the largest ratio of an error of this channel and event to its limit.
double share_of_limit(const Fitness& fitness, const std::string& event, const std::string& channel) {
  double most = 0;
  for (const auto& row : fitness.rows)
    if (row.event == event && row.channel == channel && row.samples > 0)
      most = std::max(most, thresholds::nearest(row.errors, row.limits).ratio);
  for (const auto& m : fitness.movements)
    if (m.event == event && m.channel == channel) most = std::max(most, m.error / m.limit);
  return most;
}

}  // namespace

std::string remainder_text(Remainder remainder) {
  switch (remainder) {
    case Remainder::noise:
      return ": only noise remains";
    case Remainder::uncertainty:
      return ": noise and parameter uncertainty remain";
    case Remainder::playback:
      return ", but playback exceeds noise";
  }
  return {};
}

std::string headline(bool complete, const Fitness& fitness, const std::string& model, Remainder remainder) {
  const bool judged = fitness.not_judged.empty();
  if (complete && judged && !fitness.fit)
    return remainder == Remainder::noise ? "Only noise remains, but limits are exceeded"
                                         : "The fit is adequate, but limits are exceeded";
  if (complete) return model + " matches" + remainder_text(remainder);
  if (judged && fitness.fit) return "Fit for purpose, but errors exceed noise";
  return model + " does not match the records";
}

ChannelError channel_error(const Fitness& fitness, const EventComparison& event, const ChannelComparison& c) {
  ChannelError error;
  error.bound = c.map.whole.empty() ? 0 : c.map.whole.normalised / c.map.whole.bound;
  double largest = 0;
  for (std::size_t w = 0; w < c.map.rows.size(); ++w) {
    double here = 0;
    const auto take = [&](const TimeFrequencyBin& b) {
      if (!b.empty() && b.bound > 0) here = std::max(here, b.normalised / b.bound);
    };
    take(c.map.rows[w].all);
    for (const auto& b : c.map.rows[w].bands) take(b);
    if (here > largest) largest = here, error.window = static_cast<int>(w);
  }
  error.bound = std::max(error.bound, largest);
  error.limit = share_of_limit(fitness, event.record.name, c.name);
  error.tone = error.limit > 1               ? report::Tone::bad
               : error.bound > 1 && c.judged ? report::Tone::warn
                                             : report::Tone::good;
  return error;
}

std::vector<std::string> beyond_noise(const Played& played) {
  std::vector<std::string> all;
  for (const auto& e : played.events)
    for (const auto& c : e.channels)
      if (c.judged && channel_error(played.fitness, e, c).bound > 1)
        all.push_back(c.name + " of " + e.record.name);
  return all;
}

Remainder remainder_of(const Played& played, bool noise_alone) {
  if (!beyond_noise(played).empty()) return Remainder::playback;
  return noise_alone ? Remainder::noise : Remainder::uncertainty;
}

std::pair<double, std::size_t> largest_rms_over_noise(const Played& played) {
  std::pair<double, std::size_t> largest{0, 0};
  for (std::size_t e = 0; e < played.events.size(); ++e)
    for (const auto& c : played.events[e].channels)
      if (const double ratio = c.whole.in_noise; c.judged && std::isfinite(ratio) && ratio > largest.first)
        largest = {ratio, e};
  return largest;
}

std::pair<std::size_t, std::vector<std::string>> worst_event(const Played& played) {
  std::pair<std::size_t, std::vector<std::string>> worst;
  worst.first = largest_rms_over_noise(played).second;
  if (played.events.empty()) return worst;
  const auto& channels = played.events[worst.first].channels;
  for (const auto& c : channels)
    if (c.name == "P" || c.name == "Q") worst.second.push_back(c.name);
  for (std::size_t k = 0; worst.second.empty() && k < std::min<std::size_t>(2, channels.size()); ++k)
    worst.second.push_back(channels[k].name);
  return worst;
}

std::string chart_id(std::size_t event, const std::string& channel) {
  return fmt::format("event-{}-{}", event + 1, channel);
}

std::vector<double> scaled(std::vector<double> values, double scale, double shift) {
  for (double& v : values) v = v * scale + shift;
  return values;
}

report::Curves event_chart(const EventComparison& e, const std::string& title, const std::string& unit) {
  report::Curves c{title, unit, e.record.name, e.record.t};
  if (e.switchings.empty() || e.record.t.empty()) return c;
  const double first = e.switchings.front().time;
  c.fault = {first, e.switchings.back().time};
  c.view = {std::max(first - kShownBefore, e.record.t.front()),
            std::min(first + kShownAfter, e.record.t.back())};
  return c;
}

report::Curves channel_curves(const std::vector<std::pair<const Played*, report::Ink>>& models,
                              std::size_t event, const std::string& channel) {
  report::Curves c;
  for (const auto& [played, ink] : models)
    if (const ChannelComparison* of = find_channel(played, event, channel)) {
      if (c.series.empty()) {
        c = event_chart(played->events[event], channel, of->unit);
        c.series.push_back({"measured", report::Ink::measured, scaled(of->measured, of->scale)});
      }
      c.series.push_back({played->name, ink, scaled(of->modelled, of->scale)});
    }
  c.id = chart_id(event, channel);
  return c;
}

void first_screen(report::Document& document, const FirstScreen& s) {
  document.add(report::Opening{s.headline, s.reasons, s.tone});
  if (s.before && !s.before->events.empty()) {
    document.add(chips(s));
    document.text(marks_text(s));
    large_charts(document, s);
    if (s.after && !s.after->events.empty()) document.add(fall(s));
  }
  if (!s.next.empty()) document.add(report::Paragraph{s.next, report::Paragraph::Kind::command});
}

std::string next_command(const report::Provenance& rows, const std::string& command) {
  if (rows.empty()) return {};
  std::string line = rows.front().second;
  for (const auto& [name, value] : rows)
    if (name == "command") line = value;
  const auto begin = line.find(' ');                                                // end of the program name
  const auto end = begin == std::string::npos ? begin : line.find(' ', begin + 1);  // end of the command name
  if (end == std::string::npos) return {};
  std::string rest = line.substr(end);
  if (const auto out = rest.find(" --out "); out != std::string::npos) {
    const auto next = rest.find(' ', out + 7);
    rest.erase(out, next == std::string::npos ? next : next - out);
  }
  return "swingbank " + command + rest;
}

}  // namespace swingbank::validate::compare
