#include "validate/report/detail/scaling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "validate/report/detail/summary.hpp"
#include "validate/report/detail/thesis_tables.hpp"
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

std::optional<PowerLaw> law(const std::vector<Size>& sizes, double Size::*of) {
  if (sizes.size() < kLeastSizes) return std::nullopt;
  std::vector<std::pair<double, double>> points;
  for (const auto& s : sizes) points.emplace_back(s.*of, s.mse);
  return PowerLaw(points);
}

std::string with_interval(double value, const std::optional<Interval>& interval) {
  if (!interval) return shown(value) + " (not bounded)";
  return fmt::format("{} ({} to {})", shown(value), shown(interval->first), shown(interval->second));
}

std::optional<double> thesis_of(const ScalingSeries& s) {
  double sum = 0, count = 0;
  const auto take = [&](int g) {
    if (const auto* cell = thesis_cell(s.table, s.network, g)) sum += cell->mse, ++count;
  };
  for (const int g : s.generators) take(g);
  if (s.generators.empty()) take(0);
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

PlotSeries points_of(const ScalingSeries& s, double Size::*of, const std::string& colour) {
  PlotSeries all{s.name(), colour};
  for (const auto& size : s.sizes) {
    all.points.emplace_back(size.*of, size.mse);
    all.reach.emplace_back(size.low, size.high);
  }
  return all;
}
PlotSeries law_of(const ScalingSeries& s, double Size::*of, const PowerLaw& fitted,
                  const std::string& colour) {
  PlotSeries line{"", colour};
  line.mark = PlotSeries::Mark::none;
  line.line = line.dashed = true;
  const auto [least, most] = std::ranges::minmax(s.sizes, {}, of);
  const double from = least.*of, to = most.*of;
  for (int i = 0; i <= 24; ++i) {
    const double x = from * std::pow(to / from, i / 24.0);
    const auto [low, high] = fitted.interval(x);
    line.points.emplace_back(x, fitted.at(x));
    line.band.push_back({x, low, high});
  }
  return line;
}

/// Returns a table of the given columns, with the header of `table` as first column.
Table turned(Table table, const std::vector<std::vector<Cell>>& columns) {
  Table out{std::move(table.caption), {table.header.front()}, {}};
  for (const auto& column : columns) out.header.push_back(column.front().text);
  for (std::size_t i = 1; i < table.header.size(); ++i) {
    std::vector<Cell> row = {table.header[i]};
    for (const auto& column : columns) row.push_back(column[i]);
    out.rows.push_back(std::move(row));
  }
  return out;
}

}  // namespace

std::string ScalingSeries::name() const {
  std::string text = method_name(network);
  if (noise > 0) text += ", " + level_name(noise);
  if (generators.size() == 1) text += fmt::format(", without #{}", generators.front());
  if (generators.size() > 1) text += fmt::format(", {} generators", generators.size());
  return text;
}
std::optional<PowerLaw> ScalingSeries::by_rows() const { return law(sizes, &Size::rows); }
std::optional<PowerLaw> ScalingSeries::by_time() const { return law(sizes, &Size::core_seconds); }

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
      "Power law MSE ∝ N^b (N training rows), log-log regression, 95 % confidence intervals; values beyond the largest "
      "N are extrapolated. Core-hours: one network, at the time per row measured at the largest N.",
      {"", "sizes", "training rows", "exponent b of the rows", "exponent of the time",
       "MSE at the thesis's training rows", "core-hours for these rows", "the thesis's MSE",
       "training rows required", "core-hours for these rows"},
      {}};
  std::vector<std::vector<Cell>> columns;
  for (const auto& s : series) {
    const Size &least = s.sizes.front(), &most = s.sizes.back();
    std::vector<Cell> row = {s.name(), std::to_string(s.sizes.size()),
                             fmt::format("{:.0f} – {:.0f}", least.rows, most.rows)};
    const auto rows = s.by_rows(), time = s.by_time();
    const auto at = std::ranges::find(kThesisTables, s.table, &ThesisTable::number);
    const double hours_of_row = most.core_seconds / most.rows / 3600;
    if (rows && time) {
      row.emplace_back(with_interval(rows->exponent(), rows->exponent_interval()));
      row.emplace_back(with_interval(time->exponent(), time->exponent_interval()));
    } else {
      row.insert(row.end(), {"too few sizes", "too few sizes"});
    }
    if (rows && at != kThesisTables.end()) {
      row.emplace_back(with_interval(rows->at(at->train_rows), rows->interval(at->train_rows)));
      row.emplace_back(shown(hours_of_row * at->train_rows));
    } else {
      row.insert(row.end(), {"–", "–"});
    }
    const auto thesis = thesis_of(s);
    row.emplace_back(thesis ? shown(*thesis) : "–");
    if (thesis && most.mse <= *thesis) {
      row.insert(row.end(), {"reached", "–"});
    } else if (thesis && rows && rows->exponent() < 0) {
      row.emplace_back(with_interval(rows->reaches(*thesis), rows->reaches_interval(*thesis)));
      row.emplace_back(shown(hours_of_row * rows->reaches(*thesis)));
    } else {
      row.insert(row.end(), {"–", "–"});
    }
    columns.push_back(std::move(row));
  }
  return turned(std::move(table), columns);
}

std::string scaling_picture(const std::vector<ScalingSeries>& series) {
  Plot rows{"Error against training rows", {"training rows of a run", true}, {"raw MSE", true}, {}};
  Plot time{"Error against time", {"processor time of a run [core-s]", true}, {"raw MSE", true}, {}};
  rows.width = time.width = 330;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const auto colour = plot_colour(i);
    if (const auto law = series[i].by_rows())
      rows.series.push_back(law_of(series[i], &Size::rows, *law, colour));
    if (const auto law = series[i].by_time())
      time.series.push_back(law_of(series[i], &Size::core_seconds, *law, colour));
    rows.series.push_back(points_of(series[i], &Size::rows, colour));
    time.series.push_back(points_of(series[i], &Size::core_seconds, colour));
  }
  return svg({rows, time});
}

}  // namespace swingbank::validate::report
