#include "validate/report/detail/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "validate/report/detail/thesis_tables.hpp"

namespace swingbank::validate::report {
namespace {

constexpr std::string_view kFloor = "floor", kCurveFit = "curve-fit";

std::size_t rank_of(const std::string& method) {
  static constexpr std::array<std::string_view, 4> kFirst = {"cnn", "lstm", "gru", "mlp"};
  static constexpr std::array<std::string_view, 4> kLast = {"closed-form", "refined", kCurveFit, kFloor};
  if (const auto at = std::ranges::find(kFirst, method); at != kFirst.end())
    return static_cast<std::size_t>(at - kFirst.begin());
  if (const auto at = std::ranges::find(kLast, method); at != kLast.end())
    return 100 + static_cast<std::size_t>(at - kLast.begin());
  return 50;
}

/// Returns the floor run of the same noise, seed and generator, which may have fewer rows; nullptr: none.
const RunResult* floor_of(const Task& task, const RunResult& r) {
  const auto at = std::ranges::find_if(task.runs, [&](const RunResult& f) {
    return f.network == kFloor && f.noise == r.noise && f.seed == r.seed && f.generator == r.generator;
  });
  return at == task.runs.end() ? nullptr : &*at;
}

double mean(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x;
  return sum / static_cast<double>(v.size());
}
double deviation(const std::vector<double>& v) {
  if (v.size() < 2) return 0;
  double square = 0;
  for (const double x : v) square += std::pow(x - mean(v), 2);
  return std::sqrt(square / static_cast<double>(v.size() - 1));
}

template <class Of>
auto distinct(const std::vector<RunResult>& runs, const Of& of) {
  std::set<std::decay_t<decltype(of(runs.front()))>> values;
  for (const auto& r : runs) values.insert(of(r));
  return std::vector(values.begin(), values.end());
}

}  // namespace

std::vector<std::string> Task::methods() const {
  auto all = distinct(runs, [](const RunResult& r) { return r.network; });
  std::ranges::stable_sort(all, {}, rank_of);
  return all;
}
std::vector<double> Task::levels() const {
  return distinct(runs, [](const RunResult& r) { return r.noise; });
}
std::vector<std::string> Task::makers() const {
  return distinct(runs, [](const RunResult& r) { return r.maker(); });
}
std::vector<int> Task::generators() const {
  std::set<int> all;
  for (const auto& cell : kThesisCells)
    if (cell.table == table && cell.generator > 0) all.insert(cell.generator);
  for (const auto& r : runs)
    if (r.generator > 0) all.insert(r.generator);
  return {all.begin(), all.end()};
}

std::vector<Task> tasks_of(const std::vector<RunResult>& results) {
  const auto rank = [](const std::string& table) {
    return std::ranges::find(kThesisTables, table, &ThesisTable::number) - kThesisTables.begin();
  };
  std::map<std::tuple<std::ptrdiff_t, std::string, std::string, std::int64_t, std::string, std::string>, Task>
      tasks;
  for (const auto& r : results) {
    if (r.shuffled || r.judged > 0 || r.share < 1) continue;
    Task& task = tasks[{rank(r.table), r.table, r.preset, r.rows, r.dataset, r.dataset_hash}];
    if (task.runs.empty()) task = {r.table, r.preset, r.dataset, r.dataset_hash, r.rows, {}};
    task.runs.push_back(r);
  }
  std::vector<Task> all;
  for (auto& [key, task] : tasks) all.push_back(std::move(task));
  return all;
}

std::vector<const RunResult*> runs_of(const Task& task, const Of& of) {
  std::vector<const RunResult*> runs;
  for (const auto& r : task.runs)
    if (r.network == of.method && r.noise == of.noise &&
        (of.generator == kAnyGenerator || r.generator == of.generator))
      runs.push_back(&r);
  return runs;
}

std::optional<Figure> figure_of(const Task& task, const Of& of) {
  std::map<std::int64_t, std::vector<double>> by_seed;
  std::set<int> generators;
  std::vector<double> ratio, baseline, judged, floor;
  for (const auto* r : runs_of(task, of)) {
    by_seed[r->seed].push_back(r->mse);
    generators.insert(r->generator);
    ratio.push_back(r->ratio);
    baseline.push_back(r->baseline_mse);
    if (const auto* f = floor_of(task, *r); f && of.method != kFloor)
      judged.push_back(r->mse), floor.push_back(f->mse);
  }
  if (by_seed.empty()) return std::nullopt;
  std::vector<double> seeds;
  for (const auto& [seed, values] : by_seed) seeds.push_back(mean(values));
  Figure f{mean(seeds), mean(ratio), mean(baseline), deviation(seeds), seeds.size(), generators.size(), {}};
  if (!floor.empty()) f.over_floor = mean(judged) / mean(floor);
  return f;
}

std::vector<ParameterFigure> parameter_figures(const Task& task, const Of& of) {
  const auto runs = runs_of(task, of);
  std::vector<ParameterFigure> figures;
  if (runs.empty()) return figures;
  for (const auto& p : runs.front()->parameters) {
    std::vector<double> mse, varied, variance;
    for (const auto* run : runs)
      for (const auto& q : run->parameters) {
        if (q.name != p.name) continue;
        mse.push_back(q.mse);
        if (q.relative) varied.push_back(q.mse), variance.push_back(q.variance);
      }
    ParameterFigure f{p.name, p.unit, mean(mse), {}};
    if (!variance.empty()) f.relative = mean(varied) / mean(variance);
    figures.push_back(std::move(f));
  }
  return figures;
}

double baseline_of(const Task& task, int generator) {
  std::map<int, const RunResult*> widest;  // run with most test rows; some methods use only a part of them
  for (const auto& r : task.runs) {
    if (generator != kAnyGenerator && r.generator != generator) continue;
    const auto*& best = widest[r.generator];
    if (!best || r.test_rows > best->test_rows) best = &r;
  }
  if (widest.empty()) return std::nan("");
  std::vector<double> values;
  for (const auto& [g, run] : widest) values.push_back(run->baseline_mse);
  return mean(values);
}

std::optional<double> thesis_mean(const Task& task, const std::string& method) {
  if (method == kCurveFit) return task.table == "IV" ? std::optional(kThesisPppd) : std::nullopt;
  std::vector<double> values;
  const auto take = [&](int generator) {
    if (const auto* cell = thesis_cell(task.table, method, generator)) values.push_back(cell->mse);
  };
  for (const int g : task.generators()) take(g);
  if (values.empty()) take(0);
  if (values.empty()) return std::nullopt;
  return mean(values);
}

std::string method_name(const std::string& network) {
  std::string name = network;
  std::ranges::replace(name, '-', ' ');
  if (rank_of(name.substr(0, name.find(' '))) < 50)
    for (char& c : name) {
      if (c == ' ') break;
      c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    }
  return name;
}
std::string level_name(double noise) {
  return noise > 0 ? fmt::format("noise {:g} %", 100 * noise) : "no noise";
}
std::string shown(double v) { return std::isfinite(v) ? fmt::format("{:.3g}", v) : "–"; }

}  // namespace swingbank::validate::report
