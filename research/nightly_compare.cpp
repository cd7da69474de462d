// swingbank nightly-compare FOLDER: reports scores that differ from earlier nightly runs by more than their
// noise.
//
// FOLDER contains one folder per nightly run, YYYY-MM-DD/<experiment>/results/*.json
// (docs/reference/formats.md). A cell is a result of one table, network, noise level and generator, for one
// preset and dataset config. Its score is s = ln(MSE / baseline), averaged over the run's seeds. Every run
// trains with new seeds, so the earlier runs show the random variation of a score:
//   residual of a run = s - median of the cell's earlier runs
//   noise of a table, network and level = 1.4826 * median(|residual| * sqrt(n / (n - 1)))
//     pooled over its cells, because one cell has too few runs; at least 1 %
//   moved: |s - median| > 3 noise sqrt(1 + 1.57 / n)      (1.57 / n: the variance of a median of n)
// With fewer than three earlier runs, the change is printed without a verdict.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "base/json.hpp"
#include "base/median.hpp"
#include "base/problem.hpp"
#include "jobs/command_line.hpp"

namespace swingbank::research::nightly_compare_command {
namespace {

namespace fs = std::filesystem;
using swingbank::InputError;
using swingbank::Problem;
using swingbank::Problems;

constexpr std::size_t kRunsNeeded = 3;
constexpr double kLeastRelativeNoise = 0.01;  // a change below 3 % is thus never reported

struct Cell {
  std::string table, network, noise, generator, preset, config;
  auto operator<=>(const Cell&) const = default;
};
struct Score {
  double sum = 0;  // sum of ln(MSE / baseline)
  std::size_t seeds = 0;
  std::set<std::string> makers = {};  // software versions and BLAS kernels
  [[nodiscard]] double mean() const { return sum / static_cast<double>(seeds); }
};
using NightlyRun = std::map<Cell, Score>;
using NightlyRuns = std::map<std::string, NightlyRun>;  // by date

struct Change {
  Cell cell;
  double latest = 0, before = 0, noise = 0;
  std::size_t runs = 0;
  bool other_maker = false;  // other software or BLAS kernels than in the last run
  [[nodiscard]] double limit() const {
    return 3.0 * noise * std::sqrt(1.0 + 1.57 / static_cast<double>(runs));
  }
  [[nodiscard]] bool judged() const { return runs >= kRunsNeeded; }
  [[nodiscard]] bool moved() const { return judged() && std::abs(latest - before) > limit(); }
};

bool is_date(const std::string& name) {
  if (name.size() != 10) return false;
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (i == 4 || i == 7 ? name[i] != '-' : std::isdigit(static_cast<unsigned char>(name[i])) == 0)
      return false;
  }
  return true;
}

void read_result(const fs::path& file, NightlyRun& run, Problems& problems) {
  try {
    const auto json = nlohmann::json::parse(std::ifstream(file));
    if (json.value("shuffled_labels", false) || json.value("train_share", 1.0) < 1) return;
    if (json.contains("judged") && !json["judged"].is_null()) return;
    const auto& generator = json.at("generator");
    const double ratio = json.at("mse").get<double>() / json.at("baseline_mse").get<double>();
    if (!(ratio > 0) || !std::isfinite(ratio)) {
      problems.add(fmt::format("MSE / baseline = {}", ratio), file.string(), "it must be finite and positive",
                   "delete the file and run the nightly benchmark again");
      return;
    }
    Score& score = run[{json.at("table"), json.at("network"), fmt::format("{}", json.value("noise", 0.0)),
                        generator.is_null() ? "-" : generator.dump(), json.at("preset"),
                        json.at("dataset").at("config_hash")}];
    score.sum += std::log(ratio);
    ++score.seeds;
    score.makers.insert(json.at("software").get<std::string>() + ", " + json.at("blas").get<std::string>());
  } catch (const nlohmann::json::exception& error) {
    problems.add("result cannot be read", file.string(), error.what(),
                 "delete the file and run the nightly benchmark again");
  }
}

NightlyRuns read_runs(const fs::path& folder) {
  if (!fs::is_directory(folder)) {
    throw InputError(Problem{"no folder of nightly benchmarks", folder.string(), "there is no such folder",
                             "give the --out of research/nightly.sh"});
  }
  NightlyRuns runs;
  Problems problems;
  for (const auto& run : fs::directory_iterator(folder)) {
    const std::string date = run.path().filename().string();
    if (!is_date(date) || !run.is_directory()) continue;
    for (const auto& entry : fs::recursive_directory_iterator(run.path())) {
      const auto& file = entry.path();
      if (file.extension() == ".json" && file.parent_path().filename() == "results") {
        read_result(file, runs[date], problems);
      }
    }
  }
  problems.raise();
  return runs;
}

/// Returns the changes of one run relative to all earlier runs, in the order of the cells.
std::vector<Change> changes_of(const std::string& date, const NightlyRuns& runs) {
  std::map<Cell, std::vector<double>> before;
  std::map<Cell, std::set<std::string>> makers;  // software and BLAS kernels of the last run
  for (const auto& [when, run] : runs) {
    if (when >= date) break;
    for (const auto& [cell, score] : run) {
      before[cell].push_back(score.mean());
      makers[cell] = score.makers;
    }
  }
  std::map<std::tuple<std::string, std::string, std::string>, std::vector<double>> residuals;
  for (const auto& [cell, scores] : before) {
    const double n = static_cast<double>(scores.size());
    if (scores.size() < kRunsNeeded) continue;
    for (const double score : scores) {
      residuals[{cell.table, cell.network, cell.noise}].push_back(
          std::abs(score - swingbank::median(scores)) * std::sqrt(n / (n - 1.0)));
    }
  }
  std::vector<Change> changes;
  for (const auto& [cell, score] : runs.at(date)) {
    Change change{cell, score.mean()};
    if (const auto found = before.find(cell); found != before.end()) {
      change.before = swingbank::median(found->second);
      change.runs = found->second.size();
      change.other_maker = score.makers != makers.at(cell);
      const auto& pool = residuals[{cell.table, cell.network, cell.noise}];
      if (!pool.empty()) change.noise = std::max(kLeastRelativeNoise, 1.4826 * swingbank::median(pool));
    }
    changes.push_back(change);
  }
  return changes;
}

std::string percent(double log_ratio) { return fmt::format("{:+.1f} %", 100.0 * std::expm1(log_ratio)); }

std::string verdict(const Change& c) {
  if (c.runs == 0) return "new";
  const char* word = c.other_maker ? "; software or kernels differ from the previous run" : "";
  if (!c.judged()) return fmt::format("fewer than {} runs, no verdict{}", kRunsNeeded, word);
  if (!c.moved()) return fmt::format("within noise{}", word);
  return fmt::format("**{}**{}", c.latest > c.before ? "worse" : "better", word);
}

void print_report(const std::string& date, std::vector<Change> changes) {
  std::stable_sort(changes.begin(), changes.end(),
                   [](const auto& a, const auto& b) { return a.moved() > b.moved(); });
  const auto moved = std::count_if(changes.begin(), changes.end(), [](const auto& c) { return c.moved(); });
  const auto judged = std::count_if(changes.begin(), changes.end(), [](const auto& c) { return c.judged(); });
  fmt::print(
      "# Nightly benchmark {}: {} of {} judged results changed by more than their noise ({} "
      "results in all)\n\n",
      date, moved, judged, changes.size());
  fmt::print(
      "Score: MSE / predict-the-mean (1: no better than the mean). Noise: one standard deviation, from "
      "earlier runs.\n\n");
  fmt::print(
      "| table | network | noise level | generator | preset | this run [-] | median of earlier runs [-] | change | "
      "noise | runs | verdict |\n");
  fmt::print("|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& c : changes) {
    const bool known = c.runs > 0;
    fmt::print("| {} | {} | {} | {} | {} | {:.4f} | {} | {} | {} | {} | {} |\n", c.cell.table, c.cell.network,
               c.cell.noise, c.cell.generator, c.cell.preset, std::exp(c.latest),
               known ? fmt::format("{:.4f}", std::exp(c.before)) : "-",
               known ? percent(c.latest - c.before) : "-",
               c.judged() ? fmt::format("{:.1f} %", 100.0 * c.noise) : "-", c.runs, verdict(c));
  }
}

}  // namespace

int run(jobs::CommandLine& line, int argc, char** argv) {
  std::string folder, date;
  line.add("folder", folder, "folder of nightly benchmarks, as research/nightly.sh writes it").required();
  line.add("--night", date, "date of the run, YYYY-MM-DD (default: the latest)");
  line.example("swingbank nightly-compare out/nightly");
  if (!line.parse(argc, argv)) return line.end();
  const NightlyRuns runs = read_runs(folder);
  if (runs.empty() || (!date.empty() && !runs.contains(date))) {
    throw InputError(Problem{"no results of the nightly benchmark '" + date + "'", folder,
                             "no <date>/<experiment>/results/*.json there", "run research/nightly.sh first"});
  }
  if (date.empty()) date = runs.rbegin()->first;
  print_report(date, changes_of(date, runs));
  return 0;
}

}  // namespace swingbank::research::nightly_compare_command
