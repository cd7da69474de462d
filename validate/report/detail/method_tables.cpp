#include "validate/report/detail/method_tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "validate/report/detail/thesis_tables.hpp"

namespace swingbank::validate::report {
namespace {

/// Returns the shade: 0 at `good` or below, 1 at `bad`, logarithmic between.
double shade(double value, double good, double bad) {
  return std::clamp(std::log(value / good) / std::log(bad / good), 0.0, 1.0);
}
constexpr double kGoodRelative = 0.01;  // error with shade 0, relative to a parameter's variance

/// Returns the shade of an MSE: 0 at the floor, or else at the thesis's MSE, or else at kGoodRelative times
/// the MSE of predict-the-mean; 1 at the MSE of predict-the-mean.
double shade_of(const Task& task, const Of& of, const Figure& f) {
  if (f.over_floor) return shade(f.mse, f.mse / *f.over_floor, f.baseline);
  std::optional<double> good = thesis_mean(task, of.method);
  if (of.generator != kAnyGenerator)
    if (const auto* cell = thesis_cell(task.table, of.method, of.generator)) good = cell->mse;
  return shade(f.mse, good.value_or(f.baseline * kGoodRelative), f.baseline);
}

/// Returns the methods with runs at a noise level.
std::vector<std::string> methods_at(const Task& task, double noise) {
  std::vector<std::string> names;
  for (const auto& m : task.methods())
    if (!runs_of(task, {m, noise}).empty()) names.push_back(m);
  return names;
}

/// Returns the thesis's networks, then the task's other methods.
std::vector<std::string> with_thesis(const Task& task) {
  std::vector<std::string> names;
  for (const auto& cell : kThesisCells)
    if (cell.table == task.table && std::ranges::find(names, cell.network) == names.end())
      names.emplace_back(cell.network);
  for (const auto& m : task.methods())
    if (std::ranges::find(names, m) == names.end()) names.push_back(m);
  return names;
}

std::string range(double low, double high) {
  return low == high ? fmt::format("{:.0f}", low) : fmt::format("{:.0f} – {:.0f}", low, high);
}

/// Returns whether the thesis has a figure of this method in the table.
bool has_thesis_figure(const Task& task, const std::string& method) {
  return method == "curve-fit" || std::ranges::any_of(kThesisCells, [&](const ThesisCell& cell) {
           return cell.table == task.table && cell.network == method;
         });
}

}  // namespace

Cell figure_cell(const Task& task, const Of& of, const char* otherwise) {
  const auto f = figure_of(task, of);
  if (!f) return otherwise;
  std::string text = shown(f->mse);
  if (f->seeds > 1) text += fmt::format(" ± {:.2g}", f->standard_deviation);
  text += fmt::format(" ({:.2g}", f->ratio);
  if (f->over_floor) text += fmt::format("; {:.3g} × floor", *f->over_floor);
  text += f->seeds == 1 ? ") ¹" : f->seeds == 2 ? ") ²" : ")";
  return {text, of.method == "floor" ? -1 : shade_of(task, of, *f)};
}

Table method_table(const Task& task) {
  Table table{"Each method; cells as in the first table.", {"method", "thesis, no noise"}, {}};
  const auto levels = task.levels();
  for (const double level : levels) table.header.push_back(level_name(level));
  for (const auto& method : with_thesis(task)) {
    const auto thesis = has_thesis_figure(task, method) ? thesis_mean(task, method) : std::nullopt;
    std::vector<Cell> row = {method_name(method), thesis ? shown(*thesis) : "–"};
    const bool any = std::ranges::any_of(task.runs, [&](const RunResult& r) { return r.network == method; });
    for (const double level : levels)
      row.push_back(figure_cell(task, {method, level}, any ? "–" : "missing"));
    table.rows.push_back(std::move(row));
  }
  std::vector<Cell> mean = {"predict-the-mean", "–"};
  for (std::size_t i = 0; i < levels.size(); ++i) mean.emplace_back(shown(baseline_of(task)) + " (1)");
  table.rows.push_back(std::move(mean));
  return table;
}

Table generator_table(const Task& task, double noise) {
  const auto methods = methods_at(task, noise);
  Table table{fmt::format("Each excluded generator, {}.", level_name(noise)),
              {"generator", "thesis", "predict-the-mean"},
              {}};
  for (const auto& m : methods) table.header.push_back(method_name(m));
  const auto generators = task.generators();
  for (const int g : generators) {
    const auto* thesis = thesis_cell(task.table, "cnn", g);
    std::vector<Cell> row = {fmt::format("#{}", g), thesis ? fmt::format("{:g}", thesis->mse) : "–",
                             shown(baseline_of(task, g))};
    for (const auto& m : methods) row.push_back(figure_cell(task, {m, noise, g}, "missing"));
    table.rows.push_back(std::move(row));
  }
  const auto thesis = thesis_mean(task, "cnn");
  std::vector<Cell> mean = {"mean", thesis ? shown(*thesis) : "–", shown(baseline_of(task))};
  for (const auto& m : methods) {
    const auto f = figure_of(task, {m, noise});
    Cell cell = figure_cell(task, {m, noise}, "missing");
    if (f && f->generators < generators.size()) cell.text += fmt::format(", of {}", f->generators);
    mean.push_back(std::move(cell));
  }
  table.rows.push_back(std::move(mean));
  return table;
}

Table unseen_table(const Task& task, double noise) {
  constexpr double kAim = 1.5;
  Table table{
      fmt::format(
          "Generalisation ratio, {}: MSE on the excluded generator divided by MSE on validation rows of the "
          "training generators (target ≤ {:g}).",
          level_name(noise), kAim),
      {"generator"},
      {}};
  std::vector<std::string> trained;
  for (const auto& m : methods_at(task, noise))
    if (std::ranges::any_of(runs_of(task, {m, noise}), [](const auto* r) { return std::isfinite(r->seen); }))
      trained.push_back(m);
  for (const auto& m : trained) table.header.push_back(method_name(m));
  if (trained.empty()) return table;
  const auto row_of = [&](const std::string& label, int generator) {
    std::vector<Cell> row = {label};
    for (const auto& m : trained) {
      double unseen = 0, seen = 0;
      for (const auto* r : runs_of(task, {m, noise, generator})) unseen += r->mse, seen += r->seen;
      const double ratio = seen > 0 ? unseen / seen : std::nan("");
      row.emplace_back(shown(ratio), std::isfinite(ratio) ? shade(ratio, kAim, 10 * kAim) : -1);
    }
    table.rows.push_back(std::move(row));
  };
  for (const int g : task.generators()) row_of(fmt::format("#{}", g), g);
  row_of(task.generators().empty() ? "all" : "all together", kAnyGenerator);
  return table;
}

Table parameter_comparison(const Task& task, double noise) {
  Table table{
      fmt::format("Error of each parameter, {}: raw MSE [unit²] and in brackets relative to the parameter's "
                  "variance over the test rows: 0 is exact, 1 no better than a constant guess.",
                  level_name(noise)),
      {"parameter", "unit"},
      {}};
  for (const auto& method : methods_at(task, noise)) {
    const auto figures = parameter_figures(task, {method, noise});
    table.header.push_back(method_name(method));
    if (table.rows.empty())
      for (const auto& p : figures) table.rows.push_back({p.name, p.unit});
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
      const auto p = std::ranges::find(figures, table.rows[i].front().text, &ParameterFigure::name);
      if (p == figures.end())
        table.rows[i].emplace_back("–");
      else if (!p->relative)
        table.rows[i].emplace_back(shown(p->mse) + " (constant)");
      else
        table.rows[i].emplace_back(fmt::format("{} ({:.2g})", shown(p->mse), *p->relative),
                                   shade(*p->relative, kGoodRelative, 1));
    }
  }
  return table;
}

Table several_table(const Task& task) {
  Table table{
      "Several records of one plant: raw MSE for plants with at least three test records, estimated from "
      "one, three or up to twelve records. \"mean\": mean of the records' estimates; \"product\": product "
      "of their posteriors.",
      {"method", "noise", "plants", "records", "mean", "product"},
      {}};
  for (const auto& method : task.methods())
    for (const double level : task.levels()) {
      std::map<std::int64_t, std::vector<SeveralRecords>> by_most;  // results of all seeds
      for (const auto* r : runs_of(task, {method, level}))
        for (const auto& s : r->several) by_most[s.at_most].push_back(s);
      for (const auto& [most, all] : by_most) {
        const auto n = static_cast<double>(all.size());
        double records = 0, mean = 0, product = 0;
        for (const auto& s : all) {
          records += s.records / n;
          mean += s.mse_of_mean / n;
          product += s.mse_of_product.value_or(std::nan("")) / n;
        }
        table.rows.push_back({method_name(method), level > 0 ? fmt::format("{:g} %", 100 * level) : "none",
                              std::to_string(all.front().plants), fmt::format("{:.3g}", records), shown(mean),
                              shown(product)});
      }
    }
  return table;
}

Table scatter_table(const Task& task) {
  Table table{
      "Single test rows: median of their raw MSE (mean over runs), largest, and share of rows whose MSE is not below "
      "that of predict-the-mean.",
      {"method", "noise", "median", "largest", "failed [%]"},
      {}};
  for (const auto& method : task.methods())
    for (const double level : task.levels()) {
      RowScatter all;
      double runs = 0;
      for (const auto* r : runs_of(task, {method, level})) {
        if (!r->scatter || method == "floor") continue;
        all.median += r->scatter->median;
        all.worst = std::max(all.worst, r->scatter->worst);
        all.failed += r->scatter->failed;
        ++runs;
      }
      if (runs > 0)
        table.rows.push_back({method_name(method), level > 0 ? fmt::format("{:g} %", 100 * level) : "none",
                              shown(all.median / runs), shown(all.worst),
                              fmt::format("{:.3g}", 100 * all.failed / runs)});
    }
  return table;
}

Table effort_table(const Task& task) {
  Table table{"Computing cost: rows and epochs of a run; processor time of all runs.",
              {"method", "noise", "runs", "seeds", "training rows", "test rows", "epochs", "time [core-s]",
               "software"},
              {}};
  for (const auto& method : task.methods())
    for (const double level : task.levels()) {
      const auto runs = runs_of(task, {method, level});
      if (runs.empty()) continue;
      const auto [train_low, train_high] = std::ranges::minmax(runs, {}, &RunResult::train_rows);
      const auto [test_low, test_high] = std::ranges::minmax(runs, {}, &RunResult::test_rows);
      const auto [epochs_low, epochs_high] = std::ranges::minmax(runs, {}, &RunResult::epochs);
      std::set<std::int64_t> seeds;
      std::set<std::string> software;
      double seconds = 0;
      for (const auto* r : runs) {
        seeds.insert(r->seed);
        software.insert(r->software + (r->stale ? " (stale)" : ""));
        seconds += r->core_seconds;
      }
      const bool trained = epochs_high->epochs > 0;
      const auto of = [](std::int64_t low, std::int64_t high) {
        return range(static_cast<double>(low), static_cast<double>(high));
      };
      table.rows.push_back({method_name(method), level > 0 ? fmt::format("{:g} %", 100 * level) : "none",
                            std::to_string(runs.size()), fmt::format("{}", fmt::join(seeds, ", ")),
                            trained ? of(train_low->train_rows, train_high->train_rows) : "not trained",
                            of(test_low->test_rows, test_high->test_rows),
                            trained ? of(epochs_low->epochs, epochs_high->epochs) : "–", shown(seconds),
                            fmt::format("{}", fmt::join(software, "; "))});
    }
  return table;
}

std::string against_thesis(const Task& task) {
  std::vector<std::string> lower, higher;
  for (const auto& method : task.methods()) {
    std::set<int> judged, better;
    for (const auto* r : runs_of(task, {method, 0.0})) {
      const auto* cell = thesis_cell(r->table, r->network, r->generator);
      const auto figure = figure_of(task, {method, 0.0, r->generator});
      if (!cell || !figure || method == "floor") continue;
      judged.insert(r->generator);
      if (figure->mse < cell->mse) better.insert(r->generator);
    }
    if (judged.empty()) continue;
    if (better.empty())
      higher.push_back(method_name(method));
    else
      lower.push_back(
          method_name(method) +
          (*judged.begin() > 0 ? fmt::format(" at {} of {} generators", better.size(), judged.size()) : ""));
  }
  std::string text;
  if (!lower.empty())
    text = fmt::format("MSE lower than in the thesis (noise-free): {}.", fmt::join(lower, ", "));
  if (!higher.empty())
    text += fmt::format("{}: {}.", lower.empty() ? "MSE higher than in the thesis (noise-free)" : " Higher",
                        fmt::join(higher, ", "));
  return text;
}

}  // namespace swingbank::validate::report
