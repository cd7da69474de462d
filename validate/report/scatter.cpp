// Small scatter plots side by side.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "validate/report/page.hpp"

namespace swingbank::validate::report {
namespace {

constexpr double kWidth = 300, kHeight = 210, kLeft = 62, kRight = 10, kTop = 10, kBottom = 42;

struct Range {
  double low = 1e300, high = -1e300;
  void take(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  /// Adds a margin, so that the range is never empty.
  void widen() {
    if (!(high >= low)) low = -1, high = 1;
    const double margin = high > low ? 0.05 * (high - low) : std::max(1e-6, 0.1 * std::abs(high));
    low -= margin;
    high += margin;
  }
  [[nodiscard]] double share(double v) const { return (v - low) / (high - low); }
};

std::string axis(const Range& x, const Range& y, const Scatter& s) {
  const double right = kWidth - kRight, bottom = kHeight - kBottom;
  std::string svg =
      fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#c9d3dc\"/>",
                  kLeft, kTop, right - kLeft, bottom - kTop);
  const auto label = [&](double at_x, double at_y, const char* anchor, const std::string& text) {
    svg += fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" font-size=\"11\" fill=\"#5b6b7b\">{}</text>",
        at_x, at_y, anchor, escape(text));
  };
  const auto figure = [](double v, const Range& r) {
    return fmt::format("{:.3g}", std::abs(v) < 1e-3 * (r.high - r.low) ? 0.0 : v);
  };
  label(kLeft, bottom + 14, "start", figure(x.low, x));
  label(right, bottom + 14, "end", figure(x.high, x));
  label((kLeft + right) / 2, bottom + 32, "middle", s.x_label);
  label(kLeft - 4, kTop + 10, "end", figure(y.high, y));
  label(kLeft - 4, bottom, "end", figure(y.low, y));
  svg += fmt::format(
      "<text transform=\"translate(14 {:.0f}) rotate(-90)\" text-anchor=\"middle\" font-size=\"11\" "
      "fill=\"#5b6b7b\">{}</text>",
      (kTop + bottom) / 2, escape(s.y_label));
  return svg;
}

}  // namespace

void Page::scatters(const std::vector<Scatter>& side_by_side) {
  body_ += "<div style=\"display:flex;flex-wrap:wrap;gap:4px 18px\">\n";
  for (const Scatter& s : side_by_side) {
    Range x, y;
    for (const auto& g : s.groups)
      for (const auto& [a, b] : g.points) {
        x.take(a);
        y.take(b);
      }
    x.widen();
    y.widen();
    std::string svg =
        fmt::format("<svg viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" role=\"img\" aria-label=\"{2}\">",
                    kWidth, kHeight, escape(s.title));
    svg += axis(x, y, s);
    std::string legend;
    for (const auto& g : s.groups) {
      svg += fmt::format("<g fill=\"{}\" fill-opacity=\"0.65\">", escape(g.colour));
      for (const auto& [a, b] : g.points)
        svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.8\"/>",
                           kLeft + x.share(a) * (kWidth - kRight - kLeft),
                           kHeight - kBottom - y.share(b) * (kHeight - kBottom - kTop));
      svg += "</g>";
      if (s.groups.size() > 1)
        legend += fmt::format(" <span style=\"color:{}\">● {}</span>", escape(g.colour), escape(g.name));
    }
    body_ += fmt::format("<figure style=\"margin:6px 0\"><figcaption>{}{}</figcaption>{}</svg></figure>\n",
                         escape(s.title), legend, svg);
  }
  body_ += "</div>\n";
}

}  // namespace swingbank::validate::report
