#include "validate/report/noise_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace swingbank::validate::report {
namespace {

constexpr std::string_view kFloor = "floor";

struct Mean {
  double sum = 0;
  int count = 0;
  void add(double x) { sum += x, ++count; }
  [[nodiscard]] double value() const { return sum / count; }
};

/// The floor of the same noise, seed and generator; its rows may be fewer.
const RunResult* floor_of(std::span<const RunResult> runs, const RunResult& r) {
  const auto at = std::ranges::find_if(runs, [&](const RunResult& f) {
    return f.network == kFloor && f.noise == r.noise && f.seed == r.seed && f.generator == r.generator;
  });
  return at == runs.end() ? nullptr : &*at;
}

/// "± 0.01 over 3 seeds": the standard deviation of the seeds' means.
std::string spread(const std::map<std::int64_t, Mean>& seeds) {
  if (seeds.size() < 2) return "one seed";
  Mean all;
  for (const auto& [seed, m] : seeds) all.add(m.value());
  double square = 0;
  for (const auto& [seed, m] : seeds) square += std::pow(m.value() - all.value(), 2);
  return fmt::format("± {:.2g} over {} seeds", std::sqrt(square / static_cast<double>(seeds.size() - 1)),
                     seeds.size());
}

std::string cell(std::span<const RunResult> runs, const std::string& method, double level) {
  std::map<std::int64_t, Mean> seeds;
  std::set<int> generators;
  Mean ratio, judged, floor;
  for (const auto& r : runs) {
    if (r.network != method || r.noise != level) continue;
    seeds[r.seed].add(r.mse);
    generators.insert(r.generator);
    ratio.add(r.ratio);
    if (const auto* f = floor_of(runs, r); f && method != kFloor) judged.add(r.mse), floor.add(f->mse);
  }
  if (seeds.empty()) return "–";
  Mean mse;
  for (const auto& [seed, m] : seeds) mse.add(m.value());
  std::string text = fmt::format("{:.3g} ({:.2g} × mean", mse.value(), ratio.value());
  if (floor.count > 0) text += fmt::format("; {:.3g} × floor", judged.value() / floor.value());
  if (generators.size() > 1) text += fmt::format("; {} generators", generators.size());
  return text + "; " + spread(seeds) + ")";
}

template <class Of>
auto distinct(std::span<const RunResult> runs, const Of& of) {
  std::vector<std::decay_t<decltype(of(runs.front()))>> values;
  for (const auto& r : runs)
    if (std::ranges::find(values, of(r)) == values.end()) values.push_back(of(r));
  return values;
}

std::vector<double> levels(std::span<const RunResult> runs) {
  auto all = distinct(runs, [](const RunResult& r) { return r.noise; });
  std::ranges::sort(all);
  return all;
}
std::vector<std::string> methods(std::span<const RunResult> runs) {
  auto all = distinct(runs, [](const RunResult& r) { return r.network; });
  std::ranges::stable_partition(all, [](const std::string& name) { return name != kFloor; });
  return all;
}

}  // namespace

bool has_noise_table(std::span<const RunResult> runs) {
  return !runs.empty() && (levels(runs).size() > 1 || methods(runs).size() > 1);
}

Table noise_table(std::span<const RunResult> runs) {
  Table table{
      "Methods under measurement noise. Raw MSE, its ratio to predict-the-mean and to the floor (the Bayesian "
      "Cramér-Rao bound: the least mean squared error that these noisy records allow), and the spread over "
      "seeds.",
      {"method"},
      {}};
  const auto columns = levels(runs);
  for (const double level : columns)
    table.header.push_back(level > 0 ? fmt::format("noise {:g} %", 100 * level) : "no noise");
  for (const auto& method : methods(runs)) {
    std::vector<Cell> row = {method};
    for (const double level : columns) row.emplace_back(cell(runs, method, level));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace swingbank::validate::report
