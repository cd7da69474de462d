#include "validate/report/detail/table_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/constants.hpp"
#include "validate/report/detail/thesis_tables.hpp"
#include "validate/report/plot.hpp"

namespace swingbank::validate::report {
namespace {

using Mark = PlotSeries::Mark;

/// Returns the offset of mark i in a row, so that marks do not overlap.
double aside(std::size_t i, std::size_t count) {
  return count < 2 ? 0 : 0.5 * (static_cast<double>(i) / static_cast<double>(count - 1) - 0.5);
}

}  // namespace

std::string method_picture(const Task& task) {
  const auto methods = task.methods();
  const auto levels = task.levels();
  Plot plot{fmt::format("Table {}: raw MSE of each method", task.table), {"raw MSE", true}, {}, {}};
  plot.width = 560;
  for (const auto& m : methods) plot.y.names.push_back(method_name(m));
  plot.rules.push_back({baseline_of(task), "predict-the-mean"});
  if (const auto thesis = thesis_mean(task, "cnn"))
    plot.rules.push_back({*thesis, task.table == "IV" ? "thesis's CNN" : "thesis, mean"});
  if (task.table == "IV")
    if (const auto best = thesis_mean(task, "gru")) plot.rules.push_back({*best, "thesis's GRU"});
  for (std::size_t l = 0; l < levels.size(); ++l) {
    PlotSeries each{"", plot_colour(l)}, mean{level_name(levels[l]), plot_colour(l)};
    each.size = 2.2, each.opacity = 0.45;
    mean.size = 5.5;
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const double row = static_cast<double>(m) + aside(l, levels.size());
      for (const auto* r : runs_of(task, {methods[m], levels[l]}))
        if (r->generator > 0) each.points.emplace_back(r->mse, row);
      if (const auto f = figure_of(task, {methods[m], levels[l]})) mean.points.emplace_back(f->mse, row);
    }
    plot.series.push_back(std::move(each));
    plot.series.push_back(std::move(mean));
  }
  return svg({plot});
}

std::string parameter_picture(const Task& task) {
  const auto methods = task.methods();
  const auto levels = task.levels();
  constexpr std::array kMarks = {Mark::dot, Mark::ring, Mark::diamond};
  std::vector<Plot> panels;
  double low = 1, high = 1;
  for (const double level : levels) {
    Plot plot{level_name(level), {"relative error", true}, {}, {}};
    plot.width = levels.size() > 1 ? 680.0 / static_cast<double>(levels.size()) : 480;
    plot.y.silent = !panels.empty();
    plot.rules.push_back({1.0, "constant guess"});
    std::vector<std::string> rows;  // varying parameters
    for (const auto& r : task.runs)
      for (const auto& p : r.parameters)
        if (p.relative && std::ranges::find(rows, p.name) == rows.end()) rows.push_back(p.name);
    plot.y.names = rows;
    for (std::size_t m = 0; m < methods.size(); ++m) {
      PlotSeries s{method_name(methods[m]), plot_colour(m)};
      s.mark = kMarks.at(m % kMarks.size());
      for (const auto& p : parameter_figures(task, {methods[m], level})) {
        if (!p.relative || !(*p.relative > 0)) continue;
        const auto row = std::ranges::find(rows, p.name) - rows.begin();
        s.points.emplace_back(*p.relative, static_cast<double>(row) + aside(m, methods.size()));
        low = std::min(low, *p.relative);
        high = std::max(high, *p.relative);
      }
      if (!s.points.empty()) plot.series.push_back(std::move(s));
    }
    panels.push_back(std::move(plot));
  }
  for (auto& p : panels) p.x.range = {low / 2, high * 2};  // common range of all panels
  return svg(panels);
}

std::string reliability_picture(const Task& task) {
  std::map<std::pair<std::string, double>, std::map<double, std::pair<double, double>>>
      counted;  // rows inside, all rows
  for (const auto& r : task.runs)
    for (const auto& c : r.coverage) {
      auto& [inside, rows] = counted[{r.network, r.noise}][c.nominal];
      inside += c.observed * c.rows;
      rows += c.rows;
    }
  if (counted.empty()) return {};
  Plot plot{"Coverage of the intervals",
            {"nominal coverage", false, {}, false, {0, 1}},
            {"measured coverage", false, {}, false, {0, 1}},
            {}};
  plot.width = 330;
  PlotSeries right{"nominal", "#1b2733", {{0, 0}, {1, 1}}, Mark::none};
  right.line = right.dashed = true;
  plot.series.push_back(right);
  for (const auto& [key, shares] : counted) {
    PlotSeries s{fmt::format("{}, {}", method_name(key.first), level_name(key.second)),
                 plot_colour(plot.series.size() - 1)};
    s.line = true;
    for (const auto& [nominal, sum] : shares) {
      const double share = sum.first / sum.second;
      const double half = constants::normal95 * std::sqrt(share * (1 - share) / sum.second);
      s.points.emplace_back(nominal, share);
      s.reach.emplace_back(std::max(0.0, share - half), std::min(1.0, share + half));
    }
    plot.series.push_back(std::move(s));
  }
  return svg({plot});
}

}  // namespace swingbank::validate::report
