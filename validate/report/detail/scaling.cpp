#include "validate/report/detail/scaling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "validate/report/detail/summary.hpp"
#include "validate/report/plot.hpp"

namespace swingbank::validate::report {
namespace {

using SizeKey = std::tuple<std::string, std::string, std::int64_t, double>;  // preset, dataset, rows, share
using RunsOfSize = std::map<SizeKey, std::vector<const RunResult*>>;

Size size_of(const std::vector<const RunResult*>& runs) {
  Size size;
  std::map<std::int64_t, std::pair<double, double>> seeds;  // sum, count
  const auto n = static_cast<double>(runs.size());
  for (const auto* r : runs) {
    size.rows += static_cast<double>(r->train_rows) / n;
    size.core_seconds += r->core_seconds / n;
    size.epochs += static_cast<double>(r->epochs) / n;
    size.mse += r->mse / n;
    seeds[r->seed].first += r->mse;
    seeds[r->seed].second += 1;
  }
  size.low = std::numeric_limits<double>::infinity();
  for (const auto& [seed, sum] : seeds) {
    size.low = std::min(size.low, sum.first / sum.second);
    size.high = std::max(size.high, sum.first / sum.second);
  }
  return size;
}

/// Returns the excluded generators common to all sizes; 0 means that no generator was excluded.
std::set<int> common(const RunsOfSize& sizes) {
  std::map<int, std::size_t> seen;
  for (const auto& [key, runs] : sizes) {
    std::set<int> here;
    for (const auto* r : runs) here.insert(r->generator);
    for (const int g : here) ++seen[g];
  }
  std::set<int> all;
  for (const auto& [generator, count] : seen)
    if (count == sizes.size()) all.insert(generator);
  return all;
}

PlotSeries points_of(const ScalingSeries& s, double Size::*of, const std::string& colour) {
  PlotSeries all{s.name(), colour};
  all.line = true;
  for (const auto& size : s.sizes) {
    all.points.emplace_back(size.*of, size.mse);
    all.reach.emplace_back(size.low, size.high);
  }
  return all;
}
}  // namespace

std::string ScalingSeries::name() const {
  std::string text = method_name(network);
  if (noise > 0) text += ", " + level_name(noise);
  if (generators.size() == 1) text += fmt::format(", without #{}", generators.front());
  if (generators.size() > 1) text += fmt::format(", {} generators", generators.size());
  return text;
}

std::vector<ScalingSeries> scaling_series(const std::vector<RunResult>& results) {
  std::map<std::tuple<std::string, std::string, double>, RunsOfSize> groups;
  for (const auto& r : results)
    if (!r.shuffled && r.judged == 0 && r.epochs > 0)
      groups[{r.table, r.network, r.noise}][{r.preset, r.dataset_hash, r.rows, r.share}].push_back(&r);
  std::vector<ScalingSeries> all;
  for (const auto& [key, by_size] : groups) {
    const auto generators = common(by_size);
    ScalingSeries s{std::get<0>(key), std::get<1>(key), std::get<2>(key), {}, {}};
    for (const int g : generators)
      if (g > 0) s.generators.push_back(g);
    for (const auto& [size, runs] : by_size) {
      std::vector<const RunResult*> kept;
      for (const auto* r : runs)
        if (generators.contains(r->generator)) kept.push_back(r);
      if (!kept.empty()) s.sizes.push_back(size_of(kept));
    }
    std::ranges::sort(s.sizes, {}, &Size::rows);
    if (s.sizes.size() >= kSizesToDraw && s.sizes.front().rows < s.sizes.back().rows)
      all.push_back(std::move(s));
  }
  return all;
}

Table scaling_table(const std::vector<ScalingSeries>& series) {
  Table table{
      "Raw MSE of runs with different numbers of training rows: mean over seeds, with their range. The number of "
      "optimiser steps is proportional to rows times epochs.",
      {"network", "training rows", "epochs", "processor time [s]", "MSE"},
      {}};
  for (const auto& s : series)
    for (const auto& size : s.sizes) {
      std::string mse = shown(size.mse);
      if (size.low < size.high) mse += fmt::format(" ({} to {})", shown(size.low), shown(size.high));
      table.rows.push_back(
          {s.name(), fmt::format("{:.0f}", size.rows), shown(size.epochs), shown(size.core_seconds), mse});
    }
  return table;
}

std::string scaling_picture(const std::vector<ScalingSeries>& series) {
  Plot rows{"Error against training rows", {"training rows of a run", true}, {"raw MSE", true}, {}};
  Plot time{"Error against time", {"processor time of a run [core-s]", true}, {"raw MSE", true}, {}};
  rows.width = time.width = 330;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const auto colour = plot_colour(i);
    rows.series.push_back(points_of(series[i], &Size::rows, colour));
    time.series.push_back(points_of(series[i], &Size::core_seconds, colour));
  }
  return svg({rows, time});
}

}  // namespace swingbank::validate::report
