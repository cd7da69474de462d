#pragma once
// Pictures of points, lines and bands on linear or logarithmic axes, as SVG that stands alone in a file or in
// a page.
#include <array>
#include <string>
#include <utility>
#include <vector>

namespace swingbank::validate::report {

struct PlotAxis {
  std::string label;
  bool logarithmic = false;
  std::vector<std::string> names = {};       ///< of a vertical axis: rows from the top, point i at y = i
  bool silent = false;                       ///< the names stand at the panel to the left
  std::pair<double, double> range = {0, 0};  ///< both ends the same: what the points need
};
/// Points that a logarithmic axis cannot show (0, NaN) are left out.
struct PlotSeries {
  enum class Mark { dot, ring, diamond, none };
  std::string name, colour;  ///< without a name it is not in the legend
  std::vector<std::pair<double, double>> points = {};
  Mark mark = Mark::dot;
  double size = 4.5, opacity = 1.0;  ///< [px]; of the marks
  bool line = false, dashed = false;
  std::vector<std::pair<double, double>> reach = {};  ///< of each point: least and largest y
  std::vector<std::array<double, 3>> band = {};       ///< x, low, high: shaded
};
/// A line across the plot.
struct PlotRule {
  double x = 0;
  std::string label;
};
struct Plot {
  std::string title;  ///< above the plot
  PlotAxis x, y;
  std::vector<PlotSeries> series;
  std::vector<PlotRule> rules = {};
  double width = 480;  ///< of the area [px]
};

/// The plots side by side under one legend, each name once.
std::string svg(const std::vector<Plot>& panels);

/// The colour of the i-th of several series; they repeat after nine.
std::string plot_colour(std::size_t i);

}  // namespace swingbank::validate::report
