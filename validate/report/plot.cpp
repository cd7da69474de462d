#include "validate/report/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "validate/report/document.hpp"
#include "validate/report/figures.hpp"

namespace swingbank::validate::report {
namespace {

constexpr double kRow = 26, kPlotHeight = 270;  // height of a named row, and of the area without rows [px]
constexpr double kPlotTop = 52, kPlotBottom = 42, kPlotRight = 24, kGap = 12, kLegendLine = 20, kLetter = 6.7;
constexpr const char *kInk = "#1b2733", *kSoft = "#5b6b7b", *kGrid = "#e4e9ee", *kFrame = "#c9d3dc";

double letters(const std::string& s) { return static_cast<double>(characters(s)); }

struct Words {
  const char* anchor = "start";
  const char* colour = kSoft;
  double size = 12;
  bool bold = false;
};
std::string words(double x, double y, const std::string& text, const Words& how) {
  return fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" font-size=\"{:.0f}\" fill=\"{}\"{}>{}</text>", x, y,
      how.anchor, how.size, how.colour, how.bold ? " font-weight=\"600\"" : "", escape(text));
}
std::string stroke(double x1, double y1, double x2, double y2, const char* colour, const char* more = "") {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"{}/>", x1,
                     y1, x2, y2, colour, more);
}

/// Label of a decade: 0.001 … 10000 as numbers, others as powers of ten.
std::string decade(int exponent) {
  if (exponent >= -3 && exponent <= 4) return fmt::format("{:g}", std::pow(10.0, exponent));
  static constexpr std::array<const char*, 10> kRaised = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0 ? "10⁻" : "10";
  for (const char digit : std::to_string(std::abs(exponent)))
    text += kRaised.at(static_cast<std::size_t>(digit - '0'));
  return text;
}

/// Axis scale from values to pixels.
class Scale {
 public:
  Scale(const PlotAxis& axis, double low, double high) : log_(axis.logarithmic) {
    const bool given = axis.range.first != axis.range.second;
    low_ = level(given ? axis.range.first : low);
    high_ = level(given ? axis.range.second : high);
    if (!(high_ >= low_)) low_ = 0, high_ = 1;
    if (given) return;
    const double margin = high_ > low_ ? 0.06 * (high_ - low_)
                          : log_       ? 0.3
                                       : std::max(0.1 * std::abs(high_), 1e-9);
    low_ -= margin;
    high_ += margin;
  }
  void lay(double from, double to) { from_ = from, to_ = to; }
  [[nodiscard]] double at(double v) const {
    return from_ + (level(v) - low_) / (high_ - low_) * (to_ - from_);
  }
  [[nodiscard]] bool shows(double v) const { return std::isfinite(level(v)); }
  /// Values and labels of the grid lines.
  [[nodiscard]] std::vector<std::pair<double, std::string>> ticks() const {
    return log_ ? decades() : steps();
  }

 private:
  [[nodiscard]] double level(double v) const {
    if (!log_) return v;
    return v > 0 ? std::log10(v) : std::numeric_limits<double>::quiet_NaN();
  }
  [[nodiscard]] std::vector<std::pair<double, std::string>> decades() const {
    std::vector<std::pair<double, std::string>> all;
    const int every = std::max(1, static_cast<int>(std::ceil((high_ - low_) / 9)));
    for (int e = static_cast<int>(std::ceil(low_)); e <= high_; ++e)
      if (e % every == 0) all.emplace_back(std::pow(10.0, e), decade(e));
    if (high_ - low_ > 1.6) return all;
    for (int e = static_cast<int>(std::floor(low_)); e <= high_; ++e)
      for (const double m : {2.0, 5.0})
        if (const double v = m * std::pow(10.0, e); std::log10(v) >= low_ && std::log10(v) <= high_)
          all.emplace_back(v, fmt::format("{:.3g}", v));
    return all;
  }
  [[nodiscard]] std::vector<std::pair<double, std::string>> steps() const {
    const double rough = (high_ - low_) / 5, power = std::pow(10.0, std::floor(std::log10(rough)));
    const double step = power * (rough / power > 5 ? 10 : rough / power > 2 ? 5 : rough / power > 1 ? 2 : 1);
    std::vector<std::pair<double, std::string>> all;
    for (double v = std::ceil(low_ / step) * step; v <= high_ + 1e-9 * step; v += step)
      all.emplace_back(v, fmt::format("{:.3g}", std::abs(v) < 1e-9 * step ? 0.0 : v));
    return all;
  }
  bool log_;
  double low_, high_, from_ = 0, to_ = 1;
};

Scale scale_of(const Plot& plot, bool horizontal) {
  const PlotAxis& axis = horizontal ? plot.x : plot.y;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const auto take = [&](double v) {
    if (!std::isfinite(v) || (axis.logarithmic && v <= 0)) return;
    low = std::min(low, v);
    high = std::max(high, v);
  };
  for (const auto& s : plot.series) {
    for (const auto& [x, y] : s.points) take(horizontal ? x : y);
    if (!horizontal)
      for (const auto& [a, b] : s.reach) take(a), take(b);
  }
  if (horizontal)
    for (const auto& rule : plot.rules) take(rule.x);
  return {axis, low, high};
}

class Panel {
 public:
  explicit Panel(const Plot& plot) : plot_(plot), x_(scale_of(plot, true)), y_(scale_of(plot, false)) {
    double longest = plot.y.names.empty() ? 7 : 0;
    for (const auto& name : plot.y.names) longest = std::max(longest, letters(name));
    left_ = plot.y.silent ? 8 : kLetter * longest + (plot.y.label.empty() ? 18 : 34);
    across_ = plot.width;
    down_ = plot.y.names.empty() ? kPlotHeight : kRow * static_cast<double>(plot.y.names.size());
  }
  [[nodiscard]] double width() const { return left_ + across_ + kPlotRight; }
  [[nodiscard]] double height() const { return kPlotTop + down_ + kPlotBottom; }
  std::string drawn(double x, double y) {
    left_edge_ = x + left_;
    top_ = y + kPlotTop;
    x_.lay(left_edge_, left_edge_ + across_);
    y_.lay(top_ + down_, top_);
    std::string out = words(left_edge_, y + 14, plot_.title, {"start", kInk, 13, true}) + grid() + rules();
    for (const auto& s : plot_.series) out += line(s) + marks(s);
    return out;
  }

 private:
  [[nodiscard]] double down_at(double v) const {
    return plot_.y.names.empty() ? y_.at(v) : top_ + kRow * (v + 0.5);
  }
  [[nodiscard]] std::string grid() const {
    const double right = left_edge_ + across_, bottom = top_ + down_;
    std::string out;
    for (const auto& [value, text] : x_.ticks()) {
      out += stroke(x_.at(value), top_, x_.at(value), bottom, kGrid);
      out += words(x_.at(value), bottom + 16, text, {"middle"});
    }
    if (plot_.y.names.empty()) {
      for (const auto& [value, text] : y_.ticks()) {
        out += stroke(left_edge_, y_.at(value), right, y_.at(value), kGrid);
        out += words(left_edge_ - 6, y_.at(value) + 4, text, {"end"});
      }
    } else {
      for (std::size_t i = 0; i < plot_.y.names.size(); ++i) {
        const double at = down_at(static_cast<double>(i));
        out += stroke(left_edge_, at, right, at, kGrid);
        if (!plot_.y.silent) out += words(left_edge_ - 8, at + 4, plot_.y.names[i], {"end", kInk});
      }
    }
    out += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" stroke=\"{}\"/>",
        left_edge_, top_, across_, down_, kFrame);
    out += words(left_edge_ + across_ / 2, bottom + 36, plot_.x.label, {"middle"});
    if (!plot_.y.label.empty())
      out += fmt::format(
          "<text transform=\"translate({:.1f} {:.1f}) rotate(-90)\" text-anchor=\"middle\" fill=\"{}\">{}</text>",
          left_edge_ - left_ + 13, top_ + down_ / 2, kSoft, escape(plot_.y.label));
    return out;
  }
  /// Vertical lines with labels; a label that would overlap the previous one is placed above it.
  [[nodiscard]] std::string rules() const {
    std::string out;
    double free_from = -1e9;
    auto sorted = plot_.rules;
    std::ranges::sort(sorted, {}, &PlotRule::x);
    for (std::size_t i = 0; i < sorted.size(); ++i) {
      if (!x_.shows(sorted[i].x)) continue;
      const double at = x_.at(sorted[i].x), half = kLetter * letters(sorted[i].label) / 2;
      const double middle = std::clamp(at, left_edge_ + half, left_edge_ + across_ - half + 20);
      const bool above = middle - half < free_from;
      out += stroke(at, top_ - (above ? 16 : 4), at, top_ + down_, kInk, " stroke-dasharray=\"4 3\"");
      out += words(middle, top_ - (above ? 20 : 7), sorted[i].label, {"middle", kInk, 11});
      free_from = middle + half + 6;
    }
    return out;
  }
  [[nodiscard]] bool shown(const std::pair<double, double>& p) const {
    return x_.shows(p.first) && (plot_.y.names.empty() ? y_.shows(p.second) : std::isfinite(p.second));
  }
  [[nodiscard]] std::string line(const PlotSeries& s) const {
    if (!s.line) return {};
    std::string path;
    for (const auto& p : s.points)
      if (shown(p)) path += fmt::format("{:.1f},{:.1f} ", x_.at(p.first), down_at(p.second));
    if (path.empty()) return {};
    path.pop_back();
    return fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\"{}/>", path,
                       s.colour, s.dashed ? " stroke-dasharray=\"5 4\"" : "");
  }
  [[nodiscard]] std::string marks(const PlotSeries& s) const {
    if (s.mark == PlotSeries::Mark::none) return {};
    std::string out;
    for (std::size_t i = 0; i < s.points.size(); ++i) {
      if (!shown(s.points[i])) continue;
      const double x = x_.at(s.points[i].first), y = down_at(s.points[i].second);
      if (i < s.reach.size() && y_.shows(s.reach[i].first))
        out += stroke(x, down_at(s.reach[i].first), x, down_at(s.reach[i].second), s.colour.c_str(),
                      " stroke-width=\"1.4\"");
      out += mark(s, x, y);
    }
    return out;
  }
  friend std::string legend(const std::vector<Plot>& panels, double width, double& height);
  static std::string mark(const PlotSeries& s, double x, double y) {
    const std::string seen = s.opacity < 1 ? fmt::format(" fill-opacity=\"{:g}\"", s.opacity) : "";
    switch (s.mark) {
      case PlotSeries::Mark::dot:
        return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:g}\" fill=\"{}\"{}/>", x, y, s.size,
                           s.colour, seen);
      case PlotSeries::Mark::ring:
        return fmt::format(
            "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:g}\" fill=\"#fff\" stroke=\"{}\" stroke-width=\"1.8\"/>",
            x, y, s.size, s.colour);
      case PlotSeries::Mark::diamond:
        return fmt::format("<path d=\"M{:.1f} {:.1f}l{:g} {:g}l-{:g} {:g}l-{:g} -{:g}z\" fill=\"{}\"{}/>", x,
                           y - s.size - 1, s.size + 1, s.size + 1, s.size + 1, s.size + 1, s.size + 1,
                           s.size + 1, s.colour, seen);
      case PlotSeries::Mark::none:
        break;
    }
    return {};
  }

  const Plot& plot_;
  Scale x_, y_;
  double left_ = 0, across_ = 0, down_ = 0, left_edge_ = 0, top_ = 0;
};

/// Legend, wrapped to the width; sets its `height` [px].
std::string legend(const std::vector<Plot>& panels, double width, double& height) {
  std::vector<const PlotSeries*> named;
  for (const auto& p : panels)
    for (const auto& s : p.series)
      if (!s.name.empty() && std::ranges::none_of(named, [&](const auto* n) { return n->name == s.name; }))
        named.push_back(&s);
  std::string out;
  double x = 14, y = 16;
  for (const auto* s : named) {
    const double wide = 22 + kLetter * letters(s->name) + 14;
    if (x > 14 && x + wide > width) x = 14, y += kLegendLine;
    if (s->line)
      out += stroke(x - 5, y - 4, x + 11, y - 4, s->colour.c_str(),
                    s->dashed ? " stroke-dasharray=\"5 4\"" : "");
    out += Panel::mark(*s, x + 3, y - 4) + words(x + 16, y, s->name, {"start", kInk});
    x += wide;
  }
  height = named.empty() ? 0 : y + 12;
  return out;
}

}  // namespace

std::string plot_colour(std::size_t i) {
  static constexpr std::array<const char*, 9> kColours = {
      "#2f7fc1", "#e08a1e", "#c0392b", "#2e8b57", "#7b5ea7", "#17a2a2", "#8c6d31", "#d4669b", "#5b6b7b"};
  return kColours[i % kColours.size()];
}

std::string svg(const std::vector<Plot>& panels) {
  std::vector<Panel> drawn;
  double width = 0, height = 0, key = 0;
  for (const auto& p : panels) {
    drawn.emplace_back(p);
    width += drawn.back().width() + (width > 0 ? kGap : 0);
    height = std::max(height, drawn.back().height());
  }
  std::string body = legend(panels, width, key);
  double x = 0;
  for (auto& panel : drawn) {
    body += panel.drawn(x, key);
    x += panel.width() + kGap;
  }
  std::string title;
  for (const auto& p : panels) title += (title.empty() ? "" : "; ") + p.title;
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "role=\"img\" aria-label=\"{2}\" font-family=\"system-ui, 'DejaVu Sans', sans-serif\" font-size=\"12\">"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>{3}</svg>\n",
      width, height + key, escape(title), body);
}

}  // namespace swingbank::validate::report
