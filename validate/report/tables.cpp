#include "validate/report/tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "base/capitals.hpp"
#include "base/median.hpp"
#include "validate/report/detail/method_tables.hpp"
#include "validate/report/detail/overview.hpp"
#include "validate/report/detail/scaling.hpp"
#include "validate/report/detail/table_pictures.hpp"
#include "validate/report/detail/thesis_tables.hpp"

namespace swingbank::validate::report {
namespace {

/// Returns the shade of MSE / baseline: 0 at a ratio of 0.1, 1 at a ratio of 1, logarithmic between.
double shade(double ratio) { return std::clamp(1 + std::log10(ratio), 0.0, 1.0); }

std::size_t table_rank(const std::string& table) {
  const auto at = std::ranges::find(kThesisTables, table, &ThesisTable::number);
  return static_cast<std::size_t>(at - kThesisTables.begin());
}
std::size_t network_rank(const std::string& network) {
  return static_cast<std::size_t>(std::ranges::find(kThesisNetworks, network) - kThesisNetworks.begin());
}

/// Key of a row: a network in Table IV, otherwise the excluded generator.
struct RowKey {
  std::string network;
  int generator = 0;
  [[nodiscard]] std::string label() const {
    return generator > 0 ? fmt::format("#{}", generator) : capitals(network);
  }
};

std::string thesis(const TableBlock& block, const RowKey& key) {
  const auto* cell = block.shuffled ? nullptr : thesis_cell(block.table, key.network, key.generator);
  return cell ? fmt::format("{:g}", cell->mse) : "–";
}

/// Returns the thesis's rows, then those of other runs.
std::vector<RowKey> expected_rows(const TableBlock& block) {
  std::vector<RowKey> rows;
  const auto add = [&](const RowKey& key) {
    const auto same = [&](const RowKey& k) {
      return k.network == key.network && k.generator == key.generator;
    };
    if (std::ranges::none_of(rows, same)) rows.push_back(key);
  };
  if (!block.shuffled)  // control runs exist for a few rows only
    for (const auto& cell : kThesisCells)
      if (cell.table == block.table)
        add({block.network.empty() ? std::string(cell.network) : block.network, cell.generator});
  for (const auto& run : block.runs) add({run.network, run.generator});
  return rows;
}

const RunResult* find_run(const TableBlock& block, const RowKey& key) {
  const auto at = std::ranges::find_if(block.runs, [&](const RunResult& r) {
    return r.network == key.network && r.generator == key.generator;
  });
  return at == block.runs.end() ? nullptr : &*at;
}

std::vector<Cell> score_row(const TableBlock& block, const RowKey& key) {
  const auto* run = find_run(block, key);
  std::vector<Cell> row = {key.label()};
  if (!run) {
    row.insert(row.end(), {"missing", thesis(block, key), "–", "–", "–", "–", "–", "–", "–"});
    return row;
  }
  row.emplace_back(shown(run->mse));
  row.emplace_back(thesis(block, key));
  row.emplace_back(shown(run->baseline_mse));
  row.emplace_back(shown(run->ratio), shade(run->ratio));
  row.emplace_back(shown(run->H_ratio), shade(run->H_ratio));
  row.emplace_back(shown(run->mse_varied_only));
  row.emplace_back(fmt::format("{} / {}", run->train_rows, run->test_rows));
  if (run->epochs > 0) {
    row.emplace_back(fmt::format("{} of {}", run->best_epoch, run->epochs));
    row.emplace_back(fmt::format("{:.3g} s", run->seconds_per_epoch));
  } else {
    row.insert(row.end(), {"not trained", fmt::format("{:.3g} s in all", run->seconds)});
  }
  return row;
}

/// Returns the row of means over the existing runs; the thesis's mean is over the same rows.
std::vector<Cell> mean_row(const TableBlock& block) {
  double mse = 0, thesis_mse = 0, baseline = 0, ratio = 0, h = 0, varied = 0;
  bool all_in_thesis = true;
  const auto n = static_cast<double>(block.runs.size());
  for (const auto& r : block.runs) {
    mse += r.mse / n;
    baseline += r.baseline_mse / n;
    ratio += r.ratio / n;
    h += r.H_ratio / n;
    varied += r.mse_varied_only / n;
    const auto* cell = thesis_cell(block.table, r.network, r.generator);
    if (cell)
      thesis_mse += cell->mse / n;
    else
      all_in_thesis = false;
  }
  return {fmt::format("mean of {}", block.runs.size()),
          shown(mse),
          all_in_thesis ? shown(thesis_mse) : "–",
          shown(baseline),
          Cell(shown(ratio), shade(ratio)),
          Cell(shown(h), shade(h)),
          shown(varied),
          "",
          "",
          ""};
}

std::string heading(const TableBlock& block) {
  const auto rank = table_rank(block.table);
  const bool of_thesis = rank < kThesisTables.size();
  std::string text =
      of_thesis ? fmt::format("Table {}: {}", block.table, kThesisTables[rank].title) : block.table;
  if (!block.network.empty()) text += ", " + capitals(block.network);
  if (block.noise > 0) text += fmt::format(", noise {:g} %", 100 * block.noise);
  if (block.shuffled) text += " — control run with shuffled labels";
  return text;
}
std::string made_with(const TableBlock& block) {
  return fmt::format(
      "Preset {}, dataset {} ({} rows, hash {}), seed {}. MSE: mean "
      "over the parameters of the squared error in raw units (s², pu²).",
      block.preset, block.dataset, block.rows, block.runs.front().dataset_hash, block.seed);
}
/// Replaces characters that are unsafe in a file name.
std::string safe(std::string stem) {
  std::ranges::replace_if(
      stem, [](unsigned char c) { return !std::isalnum(c) && c != '-' && c != '_' && c != '.'; }, '_');
  return stem;
}

std::string file_stem(const TableBlock& b) {
  std::string stem =
      "table-" + b.table + (b.network.empty() ? "" : "-" + b.network) +
      fmt::format("-{}-rows{}{}-seed{}{}", b.preset, b.rows,
                  b.noise > 0 ? fmt::format("-noise{}", b.noise) : "", b.seed, b.shuffled ? "-shuffled" : "");
  return safe(stem);
}

}  // namespace

std::vector<TableBlock> group_results(std::vector<RunResult> results) {
  const auto key = [](const RunResult& r) {
    return std::make_tuple(table_rank(r.table), r.table, r.shuffled,
                           r.table == "IV" ? std::string() : r.network, r.preset, r.dataset, r.dataset_hash,
                           r.rows, r.noise, r.seed);
  };
  std::ranges::stable_sort(results, [&](const RunResult& a, const RunResult& b) {
    return std::tuple_cat(key(a), std::make_tuple(network_rank(a.network), a.generator)) <
           std::tuple_cat(key(b), std::make_tuple(network_rank(b.network), b.generator));
  });
  std::vector<TableBlock> blocks;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const auto& r = results[i];
    if (i == 0 || key(r) != key(results[i - 1]))
      blocks.push_back({r.table,
                        r.table == "IV" ? "" : r.network,
                        r.preset,
                        r.dataset,
                        r.rows,
                        r.seed,
                        r.noise,
                        r.shuffled,
                        {}});
    blocks.back().runs.push_back(r);
  }
  return blocks;
}

Table score_table(const TableBlock& block) {
  const bool left_out =
      std::ranges::any_of(expected_rows(block), [](const RowKey& k) { return k.generator > 0; });
  Table table{heading(block) + ". " + made_with(block),
              {left_out ? "generator" : "network", "MSE", "thesis MSE", "predict-the-mean MSE",
               "MSE / predict-the-mean", "ratio for H alone", "MSE without constant parameters",
               "training / test rows", "best epoch", "time per epoch"},
              {}};
  for (const auto& row : expected_rows(block)) table.rows.push_back(score_row(block, row));
  if (left_out && block.runs.size() > 1) table.rows.push_back(mean_row(block));
  return table;
}

Table parameter_table(const TableBlock& block) {
  Table table{
      "Mean squared error of each parameter, raw [unit²] and relative to its variance over the test rows: 0 is "
      "exact, 1 is as good as a constant guess.",
      {"parameter", "unit", "MSE, mean of runs", "relative, median of runs", "worst", "worst run"},
      {}};
  if (block.runs.empty()) return table;
  for (const auto& p : block.runs.front().parameters) {
    std::vector<double> values;
    double worst = -1, mse = 0;
    std::string worst_run = "–";
    for (const auto& run : block.runs)
      for (const auto& q : run.parameters)
        if (q.name == p.name) {
          mse += q.mse / static_cast<double>(block.runs.size());
          if (!q.relative) continue;
          values.push_back(*q.relative);
          if (*q.relative > worst)
            worst = *q.relative, worst_run = RowKey{run.network, run.generator}.label();
        }
    if (values.empty())
      table.rows.push_back({p.name, p.unit, shown(mse), "constant", "constant", "–"});
    else
      table.rows.push_back({p.name, p.unit, shown(mse), Cell(shown(median(values)), shade(median(values))),
                            Cell(shown(worst), shade(worst)), worst_run});
  }
  return table;
}

namespace {

/// Document whose pictures are also files.
struct Report {
  Document document;
  std::vector<std::pair<std::string, std::string>> pictures = {};  ///< name and SVG
  void picture(const std::string& name, const std::string& svg, const std::string& caption) {
    if (svg.empty()) return;
    document.add(Picture{svg, caption, fmt::format("{}/{}", kPictureFolder, name)});
    pictures.emplace_back(name, svg);
  }
};

std::string made_of(const Task& task) {
  return fmt::format(
      "Preset {}, dataset {} ({} rows, hash {}). MSE: mean over the parameters of the squared error in raw "
      "units (s², pu²). {}",
      task.preset, task.dataset, task.rows, task.dataset_hash, against_thesis(task));
}

/// Adds all tables and plots of a task; `stem` begins the names of the plots' files.
void add_task(const Task& task, const std::string& stem, Report& to) {
  to.document.text(made_of(task));
  if (const auto makers = task.makers(); makers.size() > 1)
    to.document.note(fmt::format(
        "The results were computed by different software versions or processors, which may cause small differences: "
        "{}.",
        fmt::join(makers, "; ")));
  to.document.add(method_table(task));
  to.picture(stem + "-methods.svg", method_picture(task),
             task.generators().empty()
                 ? "Mean squared error of each method."
                 : "Mean squared error of each method. Large markers: mean; small markers: each excluded "
                   "generator.");
  to.picture(
      stem + "-curves.svg", curve_picture(task),
      "Validation error of each network after each epoch, mean over the runs. The error is weighted as in the "
      "training of that network; predicting the mean has about 1.");
  to.picture(stem + "-truth.svg", truth_picture(task),
             "Estimates against true values of test rows, without noise, for the parameters with the largest "
             "variance. They determine most of the MSE.");
  for (const double level : task.levels())
    if (!task.generators().empty()) {
      to.document.add(generator_table(task, level));
      if (const Table unseen = unseen_table(task, level); !unseen.rows.empty()) to.document.add(unseen);
    }
  to.picture(stem + "-parameters.svg", parameter_picture(task),
             "Error of each parameter relative to its variance.");
  for (const double level : task.levels()) to.document.add(parameter_comparison(task, level));
  to.picture(stem + "-reliability.svg", reliability_picture(task),
             "Coverage of the intervals: a point on the dashed line is an interval with nominal coverage.");
  if (const Table several = several_table(task); !several.rows.empty()) to.document.add(several);
  if (const Table scatter = scatter_table(task); !scatter.rows.empty()) to.document.add(scatter);
  to.document.add(effort_table(task));
}

void add_scaling(const std::vector<RunResult>& results, const std::string& table, const std::string& stem,
                 Report& to) {
  std::vector<RunResult> own;
  for (const auto& r : results)
    if (r.table == table) own.push_back(r);
  const auto series = scaling_series(own);
  if (series.empty()) return;
  to.document.subsection("Error against training rows and time");
  to.picture(stem + "-scaling.svg", scaling_picture(series),
             "Each point is a run, or the mean of several, with the range over seeds.");
  to.document.add(scaling_table(series));
}

/// Adds the table for the selection of network settings by nested cross-validation (runs with --judge-on).
/// Its runs exclude the same generator as the run of the table. They are evaluated on another generator, on
/// which the run of the table trains.
void add_choice(const std::vector<RunResult>& results, const std::string& table, Report& to) {
  struct Sum {
    double log_ratio = 0;
    int runs = 0;
  };
  std::map<int, std::map<std::string, Sum>> of;  // by excluded generator, then by network
  std::set<std::string> networks;
  for (const auto& r : results) {
    if (r.judged == 0 || r.table != table) continue;
    Sum& sum = of[r.generator][r.network];
    sum.log_ratio += std::log(r.ratio);
    ++sum.runs;
    networks.insert(r.network);
  }
  if (of.empty()) return;
  Table choice{
      "Selection of network settings by nested cross-validation: geometric mean of MSE / predict-the-mean over the "
      "generators on which the run of the table trains. The excluded generator was not used. The smallest "
      "value of a row is selected.",
      {"excluded", "evaluated on"},
      {}};
  for (const auto& network : networks) choice.header.push_back(method_name(network));
  for (const auto& [generator, sums] : of) {
    int runs = 0;
    for (const auto& [network, sum] : sums) runs = std::max(runs, sum.runs);
    std::vector<Cell> row = {fmt::format("#{}", generator), fmt::format("{} others", runs)};
    for (const auto& network : networks)
      row.emplace_back(
          sums.contains(network) ? shown(std::exp(sums.at(network).log_ratio / sums.at(network).runs)) : "–");
    choice.rows.push_back(std::move(row));
  }
  to.document.add(choice);
}

/// Adds the control runs of a table, if there are any.
void add_controls(const std::vector<RunResult>& results, const std::string& table, Report& to) {
  Table controls{
      "Control runs: labels shuffled before training, so nothing can be learnt, and the ratio must be about 1.",
      {"network", "preset", "generator", "MSE / predict-the-mean"},
      {}};
  for (const auto& r : results)
    if (r.shuffled && r.table == table)
      controls.rows.push_back({method_name(r.network), r.preset,
                               r.generator > 0 ? fmt::format("#{}", r.generator) : "–", shown(r.ratio)});
  if (!controls.rows.empty()) to.document.add(controls);
}

std::string remark(const std::string& table) {
  if (table == "IV")
    return fmt::format(
        "The thesis also ran EPRI's PPPD on ten of these events: MSE {:g}, the CNN on the same events {:g}. "
        "Compare the MSE of PPPD with the row of predict-the-mean.",
        kThesisPppd, kThesisCnnOnPppdEvents);
  if (table == "VI")
    return fmt::format(
        "For its GRU the thesis states only the validation MSE at which the training stopped: {:g}.",
        kThesisGruTableVI);
  return {};
}

/// Adds everything of one table: its tasks, selection of settings, control runs and scaling.
void add_table(const std::vector<RunResult>& results, const std::vector<Task>& tasks,
               const std::string& table, Report& to) {
  std::vector<const Task*> own;
  for (const auto& task : tasks)
    if (task.table == table) own.push_back(&task);
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (own.size() > 1)
      to.document.subsection(fmt::format("Preset {}, {} rows", own[i]->preset, own[i]->rows));
    add_task(*own[i], safe(i == 0 ? table : fmt::format("{}-{}", table, i + 1)), to);
  }
  add_choice(results, table, to);
  add_controls(results, table, to);
  add_scaling(results, table, safe(table), to);
  to.document.text(remark(table));
}

std::vector<std::pair<std::string, std::string>> csv_files(const std::vector<RunResult>& results,
                                                           const std::vector<Task>& tasks) {
  std::vector<std::pair<std::string, std::string>> files;
  std::vector<RunResult> whole = results;  // runs on a share of the rows are for the scaling only
  std::erase_if(whole, [](const RunResult& r) { return r.share < 1 || r.judged > 0; });
  for (const auto& block : group_results(std::move(whole))) {
    files.emplace_back(file_stem(block) + ".csv", csv(score_table(block)));
    files.emplace_back(file_stem(block) + "-parameters.csv", csv(parameter_table(block)));
  }
  for (const auto& task : tasks)
    files.emplace_back(
        safe(fmt::format("table-{}-{}-rows{}-methods", task.table, task.preset, task.rows)) + ".csv",
        csv(method_table(task)));
  return files;
}

}  // namespace

TablesReport make_tables(const std::vector<RunResult>& all, const Provenance& sources,
                         const std::string& present) {
  std::vector<RunResult> results = all;
  if (!present.empty())
    for (auto& r : results) r.stale = r.software != present;
  Report to{
      {"Calibration by learning: Tables IV, V and VI",
       "Mean squared error over the model's parameters on test events, in raw units, compared with the thesis "
       "(Y. Wu, University of Vermont, 2020, chapter 4) and with predicting the mean. Only the raw MSE may be "
       "compared with the thesis."}};
  const auto tasks = tasks_of(results);
  std::map<std::string, std::string> others;  // titles of experiments other than the thesis's tables
  for (const auto& r : results)
    if (table_rank(r.table) == kThesisTables.size()) others.emplace(r.table, r.title);
  if (!tasks.empty()) {
    to.document.add(
        Paragraph{"Green: at most the thesis's MSE (with noise: the floor). Orange: no better than "
                  "predict-the-mean.",
                  Paragraph::Kind::plain, false});
    to.document.add(overview_table(tasks));
  }
  for (const auto& table : kThesisTables) {
    const std::string number(table.number);
    to.document.section(fmt::format("Table {}: {}", table.number, table.title));
    if (std::ranges::none_of(results, [&](const RunResult& r) { return r.table == number; }))
      to.document.text(fmt::format("Table {}: no results in these folders.", table.number));
    else
      add_table(results, tasks, number, to);
  }
  for (const auto& [table, title] : others) {
    to.document.section(title.empty() ? table : fmt::format("{}: {}", table, title));
    add_table(results, tasks, table, to);
  }
  to.document.provenance(sources);
  return {markdown(to.document), html(to.document), csv_files(results, tasks), to.pictures};
}

}  // namespace swingbank::validate::report
