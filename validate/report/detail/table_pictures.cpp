#include "validate/report/detail/table_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
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

constexpr std::size_t kPanels = 4;       ///< largest number of parameters in truth_picture()
constexpr std::size_t kScattered = 400;  ///< approximate number of points of a method in a panel

/// Returns the trained method with the lowest MSE without noise, whose runs list estimates; empty: none.
std::string best_network(const Task& task, bool of_thesis) {
  std::string best;
  double lowest = 0;
  for (const auto& m : task.methods()) {
    if (of_thesis && std::ranges::find(kThesisNetworks, m) == kThesisNetworks.end()) continue;
    const auto runs = runs_of(task, {m, 0});
    const auto lists = [](const RunResult* r) {
      return !r->curve.empty() &&
             std::ranges::any_of(r->parameters, [](const auto& p) { return !p.truth.empty(); });
    };
    if (runs.empty() || !std::ranges::all_of(runs, lists)) continue;
    const double mse = figure_of(task, {m, 0})->mse;
    if (best.empty() || mse < lowest) best = m, lowest = mse;
  }
  return best;
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

std::string curve_picture(const Task& task) {
  Plot plot{"Learning curves", {"epoch"}, {"validation error", true}, {}};
  plot.width = 480;
  const auto methods = task.methods();
  for (std::size_t m = 0; m < methods.size(); ++m)
    for (const double level : task.levels()) {
      std::map<std::int64_t, std::vector<double>> at;  // by epoch
      for (const auto* r : runs_of(task, {methods[m], level}))
        for (const auto& e : r->curve) at[e.epoch].push_back(e.validation);
      if (at.empty()) continue;
      PlotSeries s{fmt::format("{}, {}", method_name(methods[m]), level_name(level)), plot_colour(m)};
      s.line = true;
      for (const auto& [epoch, values] : at) {
        double sum = 0;
        for (const double v : values) sum += v;
        s.points.emplace_back(static_cast<double>(epoch), sum / static_cast<double>(values.size()));
      }
      plot.series.push_back(std::move(s));
      break;
    }
  return plot.series.empty() ? std::string() : svg({plot});
}

std::string truth_picture(const Task& task) {
  std::vector<std::string> methods;
  for (const bool of_thesis : {true, false})
    if (const auto m = best_network(task, of_thesis);
        !m.empty() && std::ranges::find(methods, m) == methods.end())
      methods.push_back(m);
  if (methods.empty()) return {};
  std::vector<const ParameterResult*> largest;  // with varying values
  const auto runs = runs_of(task, {methods.front(), 0});
  for (const auto& p : runs.front()->parameters)
    if (!p.truth.empty()) largest.push_back(&p);
  std::ranges::stable_sort(largest, std::greater(), &ParameterResult::variance);
  largest.resize(std::min(largest.size(), kPanels));
  std::vector<Plot> panels;
  for (const ParameterResult* panel : largest) {
    Plot plot{panel->name, {fmt::format("true value [{}]", panel->unit)}, {"estimate"}, {}};
    plot.width = largest.size() > 2 ? 175 : 330;
    double low = panel->truth.front(), high = low;
    for (std::size_t m = 0; m < methods.size(); ++m) {
      PlotSeries s{method_name(methods[m]), plot_colour(m)};
      s.size = 1.8, s.opacity = 0.5;
      const auto all = runs_of(task, {methods[m], 0});
      const std::size_t each = std::max<std::size_t>(1, kScattered / all.size());
      for (const auto* r : all)
        for (const auto& p : r->parameters)
          for (std::size_t i = 0; p.name == panel->name && i < p.truth.size();
               i += std::max<std::size_t>(1, p.truth.size() / each)) {
            s.points.emplace_back(p.truth[i], p.estimate[i]);
            low = std::min({low, p.truth[i], p.estimate[i]});
            high = std::max({high, p.truth[i], p.estimate[i]});
          }
      plot.series.push_back(std::move(s));
    }
    PlotSeries right{"exact", "#1b2733", {{low, low}, {high, high}}, Mark::none};
    right.line = right.dashed = true;
    plot.series.push_back(std::move(right));
    plot.x.range = plot.y.range = {low, high};
    panels.push_back(std::move(plot));
  }
  return svg(panels);
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
