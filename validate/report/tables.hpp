#pragma once
// The thesis's Tables IV, V and VI, reproduced: each of our figures beside the thesis's and beside what a
// constant guess scores. A run that was not made is shown as missing.
#include <string>
#include <vector>

#include "validate/report/page.hpp"
#include "validate/report/run_result.hpp"

namespace swingbank::validate::report {

/// The runs of one table made with one network, preset, dataset, noise level and seed.
struct TableBlock {
  std::string table, network, preset, dataset;
  std::int64_t rows = 0, seed = 0;
  double noise = 0;
  bool shuffled = false;
  std::vector<RunResult> runs;  ///< in order of the generator
};
/// Runs grouped and sorted: by table, then control runs last, network, preset, rows and seed.
std::vector<TableBlock> group_results(std::vector<RunResult> results);

/// "Table V, cnn": one row per generator or, for Table IV, one; missing ones are named as such.
Table score_table(const TableBlock& block);
/// Error of each parameter, raw and relative to its variance over the test rows: over the runs the raw one's
/// mean, the relative one's median and worst.
Table parameter_table(const TableBlock& block);
/// Where the Markdown's pictures lie, beside it.
inline constexpr const char* kPictureFolder = "tables";

struct TablesReport {
  std::string markdown, html;                            ///< the same, with pictures as files and inside
  std::vector<std::pair<std::string, std::string>> csv;  ///< file name, content: one per table with results
  std::vector<std::pair<std::string, std::string>> pictures;  ///< SVG, in kPictureFolder
};
/// `sources`: for the provenance.
TablesReport make_tables(const std::vector<RunResult>& results, const Provenance& sources);

}  // namespace swingbank::validate::report
