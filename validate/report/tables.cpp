#include "validate/report/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "validate/report/detail/thesis_tables.hpp"
#include "validate/report/noise_table.hpp"

namespace swingbank::validate::report {
namespace {

constexpr std::array<std::string_view, 3> kTableFourNetworks = {"cnn", "lstm", "gru"};

std::string upper(std::string s) {
  std::ranges::transform(s, s.begin(), [](unsigned char c) { return std::toupper(c); });
  return s;
}
std::string figure(double v) { return std::isfinite(v) ? fmt::format("{:.3g}", v) : "–"; }
/// 0.1 of the baseline is green, 1 is red; logarithmic between.
double shade(double ratio) { return std::clamp(1 + std::log10(ratio), 0.0, 1.0); }

std::size_t table_rank(const std::string& table) {
  const auto at = std::ranges::find(kThesisTables, table, &ThesisTable::number);
  return static_cast<std::size_t>(at - kThesisTables.begin());
}
std::size_t network_rank(const std::string& network) {
  return static_cast<std::size_t>(std::ranges::find(kTableFourNetworks, network) -
                                  kTableFourNetworks.begin());
}

/// What a row of a block stands for: a network in Table IV, else the generator left out.
struct RowKey {
  std::string network;
  int generator = 0;
  [[nodiscard]] std::string label() const {
    return generator > 0 ? fmt::format("#{}", generator) : upper(network);
  }
};

std::string thesis(const TableBlock& block, const RowKey& key) {
  const auto* cell = block.shuffled ? nullptr : thesis_cell(block.table, key.network, key.generator);
  return cell ? fmt::format("{:g}", cell->mse) : "–";
}

/// The thesis's rows, then whatever else was run.
std::vector<RowKey> expected_rows(const TableBlock& block) {
  std::vector<RowKey> rows;
  const auto add = [&](const RowKey& key) {
    const auto same = [&](const RowKey& k) {
      return k.network == key.network && k.generator == key.generator;
    };
    if (std::ranges::none_of(rows, same)) rows.push_back(key);
  };
  if (!block.shuffled)  // a control run is made for a few rows only
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
  row.emplace_back(figure(run->mse));
  row.emplace_back(thesis(block, key));
  row.emplace_back(figure(run->baseline_mse));
  row.emplace_back(figure(run->ratio), shade(run->ratio));
  row.emplace_back(figure(run->H_ratio), shade(run->H_ratio));
  row.emplace_back(figure(run->mse_varied_only));
  row.emplace_back(fmt::format("{} / {}", run->train_rows, run->test_rows));
  if (run->epochs > 0) {
    row.emplace_back(fmt::format("{} of {}", run->best_epoch, run->epochs));
    row.emplace_back(fmt::format("{:.3g} s", run->seconds_per_epoch));
  } else {
    row.insert(row.end(), {"not trained", fmt::format("{:.3g} s in all", run->seconds)});
  }
  return row;
}

/// Means over the runs that exist, the thesis's over the same ones.
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
          figure(mse),
          all_in_thesis ? figure(thesis_mse) : "–",
          figure(baseline),
          Cell(figure(ratio), shade(ratio)),
          Cell(figure(h), shade(h)),
          figure(varied),
          "",
          "",
          ""};
}

std::string heading(const TableBlock& block) {
  const auto rank = table_rank(block.table);
  const bool of_thesis = rank < kThesisTables.size();
  std::string text =
      of_thesis ? fmt::format("Table {}: {}", block.table, kThesisTables[rank].title) : block.table;
  if (!block.network.empty()) text += ", " + upper(block.network);
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
/// The thesis's MSE for the run's row; 0: it gives none.
double thesis_of(const RunResult& r) {
  const auto* cell = r.shuffled ? nullptr : thesis_cell(r.table, r.network, r.generator);
  return cell ? cell->mse : 0.0;
}
std::string verdict(const TableBlock& block) {
  if (block.shuffled)
    return "Labels were shuffled before training: nothing can be learnt, and the ratio to predict-the-mean "
           "must be about 1.";
  const auto judged = std::ranges::count_if(block.runs, [](const RunResult& r) { return thesis_of(r) > 0; });
  const auto better =
      std::ranges::count_if(block.runs, [](const RunResult& r) { return r.mse < thesis_of(r); });
  const auto expected = expected_rows(block).size();
  return fmt::format("{}One seed.{}",
                     judged > 0 ? fmt::format("{} of {} runs score below the thesis. ", better, judged) : "",
                     expected > block.runs.size()
                         ? fmt::format(" Missing: {} of {} runs.", expected - block.runs.size(), expected)
                         : "");
}

/// What the thesis says beside its table.
std::string remark(const TableBlock& block) {
  if (block.shuffled) return {};
  if (block.table == "IV")
    return fmt::format(
        "The thesis also ran EPRI's PPPD on ten of these events: MSE {:g}, the CNN on the same events {:g}. "
        "Compare the former with the column of predict-the-mean.",
        kThesisPppd, kThesisCnnOnPppdEvents);
  if (block.table == "VI" && block.network == "gru")
    return fmt::format(
        "The thesis gives no table for this network; its GRU stopped at an MSE of {:g} in validation.",
        kThesisGruTableVI);
  return {};
}

/// As part of a file's name.
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

double median(std::vector<double> v) {
  std::ranges::sort(v);
  const std::size_t n = v.size();
  return n % 2 == 1 ? v[n / 2] : (v[n / 2 - 1] + v[n / 2]) / 2;
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
               "MSE / predict-the-mean", "the same, H alone", "MSE without constant parameters",
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
      table.rows.push_back({p.name, p.unit, figure(mse), "constant", "constant", "–"});
    else
      table.rows.push_back({p.name, p.unit, figure(mse), Cell(figure(median(values)), shade(median(values))),
                            Cell(figure(worst), shade(worst)), worst_run});
  }
  return table;
}

Bars ratio_bars(const TableBlock& block) {
  Bars bars{"MSE relative to predict-the-mean (lower is better; blue: below the thesis's MSE)",
            "",
            1.0,
            "predict-the-mean",
            {}};
  for (const auto& key : expected_rows(block)) {
    const auto* run = find_run(block, key);
    bars.bars.push_back({key.label(), run ? run->ratio : std::numeric_limits<double>::quiet_NaN(),
                         run && run->mse < thesis_of(*run)});
  }
  return bars;
}

namespace {
/// Whether two blocks are of the same table, preset and dataset.
bool same_task(const TableBlock& a, const TableBlock& b) {
  return a.table == b.table && a.preset == b.preset && a.dataset == b.dataset && a.rows == b.rows &&
         a.shuffled == b.shuffled;
}

/// Before the first block of a task: its methods against levels of noise.
void add_noise_table(const std::vector<TableBlock>& blocks, std::size_t first, TablesReport& report,
                     Page& page) {
  const TableBlock& block = blocks[first];
  std::vector<RunResult> runs;
  for (const auto& other : blocks)
    if (same_task(block, other)) runs.insert(runs.end(), other.runs.begin(), other.runs.end());
  if (!has_noise_table(runs)) return;
  const std::string title = fmt::format("Table {}, {}: methods and noise", block.table, block.preset);
  const Table table = noise_table(runs);
  report.markdown += fmt::format("## {}\n\n{}\n", title, markdown(table));
  page.section(title);
  page.table(table);
  std::string stem = fmt::format("table-{}-{}-rows{}-noise", block.table, block.preset, block.rows);
  report.csv.emplace_back(safe(stem) + ".csv", csv(table));
}
}  // namespace

TablesReport make_tables(const std::vector<RunResult>& results, const Provenance& sources) {
  TablesReport report;
  Page page("Calibration by learning: Tables IV, V and VI",
            "Mean squared error over the model's parameters on test events, in raw units, beside the thesis "
            "(Y. Wu, University of Vermont, 2020, chapter 4) and beside predicting the mean.");
  const auto blocks = group_results(results);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const TableBlock& block = blocks[i];
    const bool first = std::none_of(blocks.begin(), blocks.begin() + static_cast<std::ptrdiff_t>(i),
                                    [&](const TableBlock& b) { return same_task(block, b); });
    if (!block.shuffled && first) add_noise_table(blocks, i, report, page);
    const Table scores = score_table(block), parameters = parameter_table(block);
    Table plain = scores;
    plain.caption.clear();
    report.markdown += fmt::format("## {}\n\n{} {}\n\n{}\n{}\n", heading(block), made_with(block),
                                   verdict(block), markdown(plain), markdown(parameters));
    page.section(heading(block));
    page.text(made_with(block) + " " + verdict(block));
    page.table(plain);
    page.bars(ratio_bars(block));
    page.table(parameters);
    if (const auto text = remark(block); !text.empty()) {
      page.text(text);
      report.markdown += text + "\n\n";
    }
    report.csv.emplace_back(file_stem(block) + ".csv", csv(scores));
    report.csv.emplace_back(file_stem(block) + "-parameters.csv", csv(parameters));
  }
  for (const auto& table : kThesisTables)
    if (std::ranges::none_of(blocks, [&](const TableBlock& b) { return b.table == table.number; })) {
      const std::string text =
          fmt::format("Table {} ({}): no results in these folders.", table.number, table.title);
      page.text(text);
      report.markdown += text + "\n\n";
    }
  page.provenance(sources);
  report.html = page.html();
  return report;
}

}  // namespace swingbank::validate::report
