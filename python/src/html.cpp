// Notebook views: labels with the RMS error of each channel, and plots of the measured and modelled samples.
#include <fmt/format.h>

#include <cmath>

#include "python/src/native.hpp"
#include "validate/compare/event_title.hpp"
#include "validate/report/document.hpp"
#include "validate/report/plot.hpp"

namespace swingbank::python {
namespace {

using compare::ChannelComparison;
using report::escape;

constexpr const char *kGood = "#1b7a43", *kBad = "#b3401c", *kMeasured = "#1b2733", *kModelled = "#d55e00";
constexpr double kPlotWidth = 420;  // [px]
constexpr std::size_t kMostPoints = 1500;

/// Returns whether no bin of a channel's error map exceeds its noise bound. Before judge(), the bins have no
/// bounds, and the result is true.
bool is_noise(const ChannelComparison& c) {
  for (const auto& row : c.map.rows) {
    if (row.all.exceeds()) return false;
    for (const auto& bin : row.bands)
      if (bin.exceeds()) return false;
  }
  return !c.map.whole.exceeds();
}

std::string chip(const std::string& event, const ChannelComparison& c) {
  const bool noise = is_noise(c);
  return fmt::format(
      "<span title=\"{}: RMS error {:.4g} {}\" style=\"border:1px solid {};border-radius:9px;"
      "padding:1px 8px;margin-right:6px\">{} <b>{}</b> {:.3g} ×</span>",
      escape(event), c.whole.rms * c.scale, escape(c.unit), noise ? kGood : kBad, noise ? "●" : "▲",
      escape(c.name), c.whole.in_noise);
}

/// Returns the points of a curve: all samples, or every n-th sample of a long record.
std::vector<std::pair<double, double>> points(const std::vector<double>& t, const std::vector<double>& y,
                                              double scale) {
  std::vector<std::pair<double, double>> all;
  const std::size_t every = 1 + t.size() / kMostPoints;
  for (std::size_t k = 0; k < y.size() && k < t.size(); k += every) all.emplace_back(t[k], y[k] * scale);
  return all;
}

report::Plot axes(const std::string& name, const std::string& unit) {
  report::Plot p;
  p.title = name;
  p.x.label = "t [s]";
  p.y.label = fmt::format("{} [{}]", name, unit);
  p.width = kPlotWidth;
  return p;
}

report::PlotSeries curve(const char* name, const char* colour, std::vector<std::pair<double, double>> at) {
  report::PlotSeries s;
  s.name = name;
  s.colour = colour;
  s.points = std::move(at);
  s.mark = report::PlotSeries::Mark::none;
  s.line = true;
  return s;
}

report::Plot plot(const std::vector<double>& t, const ChannelComparison& c) {
  report::Plot p = axes(c.name, c.unit);
  p.series = {curve("measured", kMeasured, points(t, c.measured, c.scale)),
              curve("modelled", kModelled, points(t, c.modelled, c.scale))};
  return p;
}

}  // namespace

std::string verdict_html(const std::string& sentence, bool good) {
  return fmt::format("<p style=\"color:{}\">{}</p>", good ? kGood : kBad, escape(sentence));
}

std::string html_of(const Record& r) {
  std::vector<report::Plot> plots;
  const auto add = [&](const char* name, const char* unit, const std::vector<double>& values, double scale) {
    if (values.empty()) return;
    report::Plot p = axes(name, unit);
    p.series.push_back(curve("", kMeasured, points(r.record.t, values, scale)));
    plots.push_back(std::move(p));
  };
  add("V", "pu", r.record.V, 1);
  add("P", "MW", r.record.P, r.record.base.mva);
  add("Q", "Mvar", r.record.Q, r.record.base.mva);
  return "<div><p><b>" + escape(r.record.name) + "</b></p>" + report::svg(plots) + "</div>";
}

std::string html_of(const Playback& p) {
  const std::string title = p.event.record.name + ", " + compare::event_title(p.event);
  std::string text = fmt::format("<div><p><b>{}</b></p><p>", escape(title));
  std::vector<report::Plot> plots;
  for (const auto& c : p.event.channels) {
    text += chip(p.event.record.name, c);
    plots.push_back(plot(p.event.record.t, c));
  }
  return text + "(RMS error as a multiple of the noise)</p>" + report::svg(plots) + "</div>";
}

std::string html_of(const Comparison& c) {
  std::string text = "<div>";
  if (c.fitness.not_judged.empty()) text += verdict_html(c.fitness.sentence, c.fitness.fit);
  text += verdict_html(c.adequacy.sentence, c.adequacy.adequate);
  for (const auto& e : c.events) text += html_of(*e);
  return text + "</div>";
}

}  // namespace swingbank::python
