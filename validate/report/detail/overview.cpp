#include "validate/report/detail/overview.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>
#include <span>

#include "validate/report/detail/method_tables.hpp"
#include "validate/report/detail/thesis_tables.hpp"

namespace swingbank::validate::report {
namespace {

constexpr int kEquivalent = 39;  ///< bus of the equivalent of a neighbouring grid in the IEEE 39-bus system
constexpr int kWorst = -2;       ///< generator with the largest MSE; cf. kAnyGenerator

/// A method with its runs in one task.
struct Candidate {
  const Task* task = nullptr;
  std::string method;
  Figure figure;
  std::int64_t samples = 0;  ///< training rows times epochs, or test rows of a method without training
  bool trained = false;
};

std::int64_t samples_of(const RunResult& r) { return r.epochs > 0 ? r.train_rows * r.epochs : r.test_rows; }

std::vector<Candidate> candidates(std::span<const Task> tasks, double noise) {
  std::vector<Candidate> all;
  for (const Task& task : tasks)
    for (const auto& method : task.methods()) {
      const auto figure = figure_of(task, {method, noise});
      if (!figure) continue;
      const RunResult& run = *runs_of(task, {method, noise}).front();
      all.push_back({&task, method, *figure, samples_of(run), run.epochs > 0});
    }
  return all;
}

bool is_thesis_network(const Candidate& c) {
  const std::string kind = c.method.substr(0, c.method.find('-'));
  return kind == "cnn" || kind == "lstm" || kind == "gru";
}
bool more_samples(const Candidate& a, const Candidate& b) { return a.samples > b.samples; }
bool less_error(const Candidate& a, const Candidate& b) { return a.figure.mse < b.figure.mse; }

/// Column of the table: the candidates that it may show, and the order in which it prefers them.
struct Column {
  const char* title;
  std::function<bool(const Candidate&)> wanted;
  bool (*better)(const Candidate&, const Candidate&);
};
const std::array<Column, 5>& columns() {
  const auto named = [](const char* name) { return [name](const Candidate& c) { return c.method == name; }; };
  static const std::array<Column, 5> all = {{
      {"thesis's network, longest training", is_thesis_network, more_samples},
      {"best network", [](const Candidate& c) { return c.trained; }, less_error},
      {"network and search", [](const Candidate& c) { return c.method.ends_with("-steps"); }, less_error},
      {"refined", named("refined"), more_samples},
      {"floor", named("floor"), more_samples},
  }};
  return all;
}

int worst_generator(const Candidate& c, double noise) {
  int worst = kAnyGenerator;
  double most = -1;
  for (const int g : c.task->generators())
    if (const auto f = figure_of(*c.task, {c.method, noise, g}); f && f->mse > most) most = f->mse, worst = g;
  return worst;
}

Cell cell_of(const Candidate& c, double noise, int generator) {
  const Of of{c.method, noise, generator == kWorst ? worst_generator(c, noise) : generator};
  Cell cell = figure_cell(*c.task, of, "–");
  const auto runs = runs_of(*c.task, of);
  if (runs.empty()) return cell;
  const RunResult& run = *runs.front();
  if (std::ranges::any_of(runs, [](const RunResult* r) { return r->stale; })) cell.text += " stale";
  if (generator == kWorst) cell.text += fmt::format(", #{}", of.generator);
  if (const std::size_t all = c.task->generators().size(); generator < 0 && c.figure.generators < all)
    cell.text += fmt::format(", of {} of {} folds", c.figure.generators, all);
  cell.text =
      c.trained ? fmt::format("{} {}, {} × {}", method_name(c.method), cell.text, run.train_rows, run.epochs)
                : fmt::format("{}, {}", cell.text, run.test_rows);
  return cell;
}

std::optional<double> thesis_figure(const Task& task, int generator) {
  if (generator == kAnyGenerator || generator == 0)
    return thesis_mean(task, task.table == "IV" ? "gru" : "cnn");
  std::optional<double> figure;
  for (const auto& cell : kThesisCells)
    if (cell.table == task.table && (cell.generator == generator || generator == kWorst))
      figure = std::max(figure.value_or(0), cell.mse);
  return figure;
}

std::string label_of(const std::string& table, double noise, int generator) {
  std::string text = table;
  if (generator == kAnyGenerator) text += ", mean";
  if (generator == kWorst) text += ", worst";
  if (generator > 0) text += fmt::format(", #{}", generator);
  return text + ", " + level_name(noise);
}

/// Adds the rows of the tasks of one table.
void add_rows(std::span<const Task> tasks, Table& table) {
  const bool folds = !tasks.front().generators().empty();
  std::vector<int> statistics = {folds ? kAnyGenerator : 0};
  if (folds) statistics.push_back(kWorst);
  if (folds && tasks.front().table == "V") statistics.push_back(kEquivalent);
  std::set<double> levels;
  for (const Task& task : tasks)
    for (const double level : task.levels()) levels.insert(level);
  for (const int statistic : statistics)
    for (const double noise : levels) {
      const auto all = candidates(tasks, noise);
      std::vector<Cell> row = {label_of(tasks.front().table, noise, statistic)};
      const auto thesis = noise > 0 ? std::nullopt : thesis_figure(tasks.front(), statistic);
      row.emplace_back(thesis ? shown(*thesis) : "–");
      for (const Column& column : columns()) {
        const Candidate* best = nullptr;
        for (const Candidate& c : all)
          if (column.wanted(c) && (!best || column.better(c, *best))) best = &c;
        row.push_back(best ? cell_of(*best, noise, statistic) : Cell("–"));
      }
      table.rows.push_back(std::move(row));
    }
}

}  // namespace

Table overview_table(const std::vector<Task>& tasks) {
  Table table{
      fmt::format(
          "{} Behind the brackets: training rows × epochs, or test rows of a method without training; "
          "stale: computed by other software than the present one.",
          kCellMeaning),
      {"table", "thesis"},
      {}};
  for (const Column& column : columns()) table.header.emplace_back(column.title);
  for (auto first = tasks.begin(); first != tasks.end();) {
    const auto last =
        std::ranges::find_if(first, tasks.end(), [&](const Task& t) { return t.table != first->table; });
    add_rows({first, last}, table);
    first = last;
  }
  return table;
}

}  // namespace swingbank::validate::report
