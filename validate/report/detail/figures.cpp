#include "validate/report/detail/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

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
  std::string svg = fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" class=\"frame\"/>", kLeft,
                                kTop, right - kLeft, bottom - kTop);
  const auto label = [&](double at_x, double at_y, const char* anchor, const std::string& text) {
    svg += fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" font-size=\"11\" class=\"soft\">{}</text>", at_x,
        at_y, anchor, escape(text));
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
      "class=\"soft\">{}</text>",
      (kTop + bottom) / 2, escape(s.y_label));
  return svg;
}

}  // namespace

const char* ink_name(Ink ink) {
  static constexpr std::array kNames = {"measured", "ghost", "model", "third", "inferred", "limit"};
  return kNames.at(static_cast<std::size_t>(ink));
}

std::string bars_svg(const Bars& b) {
  constexpr double width = 290, top = 26;
  const bool pairs = std::ranges::any_of(b.bars, [](const auto& bar) { return bar.label.empty(); });
  const double line = pairs ? 17 : 24, thick = pairs ? 13 : 16;
  std::size_t longest = 0;
  for (const auto& bar : b.bars) longest = std::max(longest, bar.label.size());
  constexpr double kCapital = 8.6;  // width of a capital letter [px]; names of effects consist of capitals
  const double left = std::max(70.0, 12 + kCapital * static_cast<double>(longest));
  double largest = b.reference * 1.1;
  for (const auto& bar : b.bars)
    if (std::isfinite(bar.value)) largest = std::max(largest, bar.value * 1.02);
  if (!(largest > 0)) largest = 1;
  const double height = top + line * static_cast<double>(b.bars.size()) + 8;
  std::string svg =
      fmt::format("<svg viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" role=\"img\" aria-label=\"{2}\">",
                  left + width + 90, height, escape(b.title));
  double y = top;
  for (const auto& bar : b.bars) {
    const double w = std::isfinite(bar.value) ? std::max(width * bar.value / largest, 1.0) : 0;
    svg += fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"end\">{}</text>", left - 8,
                       y + thick + 1, escape(bar.label));
    svg += fmt::format(
        "<rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"{:.1f}\" height=\"{:.0f}\" rx=\"2\" class=\"{}\"/>", left,
        y + 4, w, thick, bar.style);
    svg +=
        fmt::format("<text x=\"{:.1f}\" y=\"{:.0f}\" class=\"soft\">{}</text>", left + w + 6, y + thick + 1,
                    !bar.shown.empty() ? escape(bar.shown)
                    : std::isfinite(bar.value)
                        ? fmt::format("{:.3g}{}", bar.value, b.unit.empty() ? "" : " " + escape(b.unit))
                        : "not finite");
    y += line;
  }
  if (b.reference > 0) {
    const double x = left + width * b.reference / largest;
    svg += fmt::format("<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.0f}\" y2=\"{2:.0f}\" class=\"rule\"/>",
                       x, top - 6, height - 4);
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.0f}\" text-anchor=\"{}\">{}</text>",
                       x < left + 70 ? left : x + 4, top - 12, x < left + 70 ? "start" : "end",
                       escape(b.reference_label));
  }
  return svg + "</svg>";
}

std::string scatter_svg(const Scatter& s) {
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
  for (const auto& g : s.groups) {
    svg += fmt::format("<g class=\"{}\" fill-opacity=\"0.65\">", ink_name(g.ink));
    for (const auto& [a, b] : g.points)
      svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.8\"/>",
                         kLeft + x.share(a) * (kWidth - kRight - kLeft),
                         kHeight - kBottom - y.share(b) * (kHeight - kBottom - kTop));
    svg += "</g>";
  }
  return svg + "</svg>";
}

std::string scatter_legend(const Scatter& s) {
  std::string legend = escape(s.title);
  if (s.groups.size() > 1)
    for (const auto& g : s.groups)
      legend += fmt::format(" <span style=\"color:var(--{})\">●</span> {}", ink_name(g.ink), escape(g.name));
  return legend;
}

}  // namespace swingbank::validate::report
