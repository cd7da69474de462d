#pragma once
// Plots of points, lines and bands on linear or logarithmic axes, as self-contained SVG for files and pages.
#include <array>
#include <string>
#include <utility>
#include <vector>

namespace swingbank::validate::report {

/// Axis of a plot.
struct PlotAxis {
  std::string label;                         ///< label with unit
  bool logarithmic = false;                  ///< logarithmic scale
  std::vector<std::string> names = {};       ///< vertical axis only: row names from the top, row i at y = i
  bool silent = false;                       ///< omit the names, which the panel to the left shows
  std::pair<double, double> range = {0, 0};  ///< range of values; equal ends: that of the points
};
/// Series of a plot. Points that a logarithmic axis cannot show (0, NaN) are omitted.
struct PlotSeries {
  /// Mark of a point.
  enum class Mark { dot, ring, diamond, none };
  std::string name, colour;                            ///< an empty name is not in the legend
  std::vector<std::pair<double, double>> points = {};  ///< x and y of each point
  Mark mark = Mark::dot;                               ///< mark of the points
  double size = 4.5, opacity = 1.0;                    ///< size [px] and opacity of the marks
  bool line = false, dashed = false;                   ///< points are joined by a line; the line is dashed
  std::vector<std::pair<double, double>> reach = {};   ///< error bars: least and largest y of each point
};
/// Vertical line across the plot.
struct PlotRule {
  double x = 0;       ///< position on the horizontal axis
  std::string label;  ///< label of the line
};
/// Plot with its axes, series and vertical lines.
struct Plot {
  std::string title;                 ///< title above the plot
  PlotAxis x, y;                     ///< horizontal and vertical axis
  std::vector<PlotSeries> series;    ///< series, drawn in order
  std::vector<PlotRule> rules = {};  ///< vertical lines
  double width = 480;                ///< width of the plot area [px]
};

/// Plots side by side under a common legend that has each name once.
std::string svg(const std::vector<Plot>& panels);

/// Colour of series i; colours repeat after nine.
std::string plot_colour(std::size_t i);

}  // namespace swingbank::validate::report
