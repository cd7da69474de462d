// swingbank tables: writes results of training runs as the thesis's Tables IV, V and VI, in Markdown, CSV and
// HTML.
#include "validate/report/tables.hpp"

#include <fmt/format.h>

#include <set>

#include "base/write_file.hpp"
#include "jobs/command_line.hpp"

namespace swingbank::jobs::tables_command {
namespace {

using namespace validate;

report::Provenance sources(const std::vector<report::RunResult>& results, int argc, char** argv) {
  std::string line = "swingbank tables";
  for (int i = 1; i < argc; ++i) line += std::string(" ") + argv[i];
  report::Provenance rows = {{"command", line}, {"results read", std::to_string(results.size())}};
  std::set<std::string> datasets, software;
  for (const auto& r : results) {
    datasets.insert(
        fmt::format("{}: {} rows, hash {}, config {}", r.dataset, r.rows, r.dataset_hash, r.config_hash));
    software.insert(r.maker());
  }
  for (const auto& d : datasets) rows.emplace_back("dataset", d);
  for (const auto& s : software) rows.emplace_back("software of the runs", s);
  return rows;
}

}  // namespace

int run(CommandLine& line, int argc, char** argv) {
  std::vector<std::string> folders;
  std::string out, software;
  line.add("results", folders, "folders with the JSON files of train and cross-validate").required();
  line.add("--out", out, "folder for tables.md with its pictures, tables.html and CSV files").required();
  line.add("--software", software,
           "present software, as in key software of a result; results of other software are "
           "marked as stale");
  line.example("swingbank tables results --out tables");
  if (!line.parse(argc, argv)) return line.end();
  const auto results = report::read_results({folders.begin(), folders.end()});
  const report::TablesReport report = report::make_tables(results, sources(results, argc, argv), software);
  const std::filesystem::path folder = out;
  for (const auto& [name, content] : report.csv) write_file(folder / name, content);
  for (const auto& [name, content] : report.pictures)
    write_file(folder / report::kPictureFolder / name, content);
  write_file(folder / "tables.md", report.markdown);
  write_file(folder / "tables.html", report.html);
  fmt::print("{}summary: {}\n", report.markdown, (folder / "tables.html").string());
  return 0;
}

}  // namespace swingbank::jobs::tables_command
