#pragma once
// Reproduction of the thesis's Tables IV, V and VI: results of the runs, of the thesis, and of predicting the
// mean. Absent runs are shown as missing.
#include <string>
#include <vector>

#include "validate/report/document.hpp"
#include "validate/report/run_result.hpp"

namespace swingbank::validate::report {

/// Runs of one table with the same network (in Table IV: any network), preset, dataset, noise level and seed.
struct TableBlock {
  std::string table, network, preset, dataset;  ///< common properties of the runs
  std::int64_t rows = 0, seed = 0;              ///< rows of the dataset; seed of the runs
  double noise = 0;                             ///< level of measurement noise
  bool shuffled = false;                        ///< control runs with shuffled labels
  std::vector<RunResult> runs;                  ///< in order of the generator
};
/// Groups the runs and sorts them by table, control runs last, then network, preset, dataset, rows, noise and
/// seed.
std::vector<TableBlock> group_results(std::vector<RunResult> results);

/// Table of errors: one row per excluded generator, or per network in Table IV; missing runs are marked.
Table score_table(const TableBlock& block);
/// Table of each parameter's error: mean of the raw MSE over the runs, and median and worst of the MSE
/// relative to the parameter's variance over the test rows.
Table parameter_table(const TableBlock& block);
/// Folder of the Markdown's pictures, relative to its file.
inline constexpr const char* kPictureFolder = "tables";

/// Tables of the results as Markdown, page and CSV.
struct TablesReport {
  std::string markdown, html;                            ///< same content; only the page embeds the pictures
  std::vector<std::pair<std::string, std::string>> csv;  ///< name, content: two per TableBlock, one per task
  std::vector<std::pair<std::string, std::string>> pictures;  ///< SVG, in kPictureFolder
};
/// Builds the report; `sources` is its provenance. Results of other software than `present` are marked as
/// stale; with an empty text none is.
TablesReport make_tables(const std::vector<RunResult>& results, const Provenance& sources,
                         const std::string& present = {});

}  // namespace swingbank::validate::report
