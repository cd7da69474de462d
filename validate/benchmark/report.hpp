#pragma once
// Report of a benchmark as terminal text, JSON, CSV and HTML page.
#include <string>
#include <vector>

#include "validate/benchmark/benchmark.hpp"
#include "validate/report/document.hpp"

namespace swingbank::validate::benchmark {

/// Information that the reports show in addition to the results.
struct ReportContext {
  const plant::PlantModel& model;  ///< model under test
  std::string reference;           ///< "EMT records", or the name of the reference model
  const TestSet& set;              ///< tests
  thresholds::Acceptance by;       ///< limits
  report::Provenance provenance;   ///< inputs and software of the run
};

/// Table with one row per test: verdict, and the error nearest to its limit.
report::Table summary_table(const std::vector<TestResult>& results);
/// Table of MXE, ME and MAE per test, channel and window [%], with their limits.
report::Table error_table(const std::vector<TestResult>& results, const ReportContext& context);

/// Terminal text: verdict and table of the tests; with `verbose` also the table of the errors.
std::string terminal_report(const std::vector<TestResult>& results, const ReportContext& context,
                            bool verbose);
/// JSON of all errors and limits (docs/reference/benchmark.md).
std::string json_report(const std::vector<TestResult>& results, const ReportContext& context);
/// CSV of all errors in pu and %, with their limits.
std::string csv_report(const std::vector<TestResult>& results);
/// CSV of the samples of one test: V and theta, then each channel of reference and model [pu].
std::string csv_curves(const TestResult& result);
/// Self-contained page: verdict, tables, and reference and model overlaid for each test.
std::string html_report(const std::vector<TestResult>& results, const ReportContext& context);

}  // namespace swingbank::validate::benchmark
