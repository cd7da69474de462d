// swingbank benchmark: compares an RMS model with EMT records, or with another model, over a set of tests.
#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <map>
#include <optional>

#include "base/output_folder.hpp"
#include "base/write_file.hpp"
#include "jobs/event_records.hpp"
#include "jobs/verdict.hpp"
#include "validate/benchmark/generated_input.hpp"
#include "validate/benchmark/report.hpp"
#include "validate/plant/plant_model.hpp"
#include "validate/thresholds/adequacy.hpp"

namespace swingbank::jobs::benchmark_command {
namespace {

using namespace validate;

constexpr const char *kPage = "report.html", *kResult = "benchmark.json", *kTable = "benchmark.csv";

struct Arguments {
  std::string model, tests, against, out = "benchmark-report", command;
  std::vector<std::string> records, user_model_files;
  bool json = false, verbose = false;
  int threads = 0;
  jobs::Reading reading;
  jobs::Judging judging;
};

std::string curves_name(const benchmark::Test& test) { return "curves-" + test.name + ".csv"; }

plant::PlantModel load(const std::string& file, const Arguments& a) {
  plant::PlantModel model = plant::load_plant_model(
      file, std::vector<std::filesystem::path>(a.user_model_files.begin(), a.user_model_files.end()));
  jobs::print_warnings(model);
  return model;
}

/// Returns "bus 2 (manufacturer.toml)", with the machine base if it differs from that of the model under
/// test. The file name distinguishes two models of one plant, because both have the plant's name.
std::string reference_name(const plant::PlantModel& reference, const plant::PlantModel& tested) {
  const std::string base =
      reference.plant.mva == tested.plant.mva ? "" : fmt::format(", {:g} MVA", reference.plant.mva);
  return fmt::format("{} ({}{})", reference.name, std::filesystem::path(reference.origin).filename().string(),
                     base);
}

/// Returns the record of each test, read or generated; empty for tests behind a grid impedance.
std::vector<record::Record> read_inputs(const benchmark::TestSet& set, plant::PlantModel& model,
                                        const Arguments& a, Problems& problems) {
  std::vector<std::string> files;
  for (const auto& t : set.tests)
    if (!t.record.empty() && std::ranges::count(files, t.record.string()) == 0)
      files.push_back(t.record.string());
  const check::Preparing columns = a.reading.apply(model, files);
  // A record is checked together with the steps of Vref or Pref in its tests, because these steps change P
  // and Q without a change of the voltage.
  const auto prepare = [&](record::Record r) {
    for (const auto& t : set.tests)
      if (benchmark::is_reference_step(t.kind) && record::Source(t.record).name == r.name && r.staged.empty())
        r.staged = {{record::StagedEvent::Kind::vref_step, t.event}};
    return columns(std::move(r));
  };
  const check::RecordSet read = check::read_records(files, model, problems, prepare);
  problems.raise();
  std::map<std::string, std::size_t> places;
  for (std::size_t k = 0; k < files.size(); ++k) {
    places[files[k]] = k;
    for (const auto& warning : read.warnings[k])
      if (!jobs::quiet) fmt::print(stderr, "note on {}: {}\n", read.records[k].name, warning);
  }
  std::vector<record::Record> records;
  for (const auto& t : set.tests)
    records.push_back(t.behind_impedance() ? record::Record{}
                      : t.record.empty()   ? benchmark::generated_input(t, *set.initial, model)
                                           : read.records[places.at(t.record.string())]);
  return records;
}

report::Provenance provenance(const Arguments& a, const benchmark::TestSet& set) {
  report::Provenance rows = {
      {"command", a.command}, {"software", std::string("swingbank ") + jobs::version()}, {"model", a.model}};
  if (!a.against.empty()) rows.emplace_back("reference model", a.against);
  rows.emplace_back("tests", set.file.string() + (set.source.empty() ? "" : ", " + set.source));
  std::vector<std::string> files = {a.tests};
  if (!a.against.empty()) files.push_back(a.against);
  for (const auto& t : set.tests)
    if (!t.record.empty() && std::ranges::count(files, t.record.string()) == 0)
      files.push_back(t.record.string());
  jobs::sign(rows, a.judging, a.model, files);
  return rows;
}

int run(Arguments& a) {
  a.judging.read();
  plant::PlantModel model = load(a.model, a);
  std::optional<plant::PlantModel> against;
  if (!a.against.empty()) against = load(a.against, a);
  benchmark::TestSet set = benchmark::load_tests(a.tests);
  Problems problems;
  benchmark::find_records(set, a.records, against.has_value(), problems);
  benchmark::check_controls(set, model, problems);
  if (against && a.against != a.model) {
    benchmark::check_controls(set, *against, problems);
    if (against->conventions.frequency != model.conventions.frequency)
      problems.add(fmt::format("nominal frequencies of {:g} and {:g} Hz", model.conventions.frequency,
                               against->conventions.frequency),
                   "--against", "both models must have the same nominal frequency",
                   "give two plant files with the same plant.frequency_hz");
  }
  problems.raise();
  const std::vector<record::Record> records = read_inputs(set, model, a, problems);
  std::vector<std::string> names = {kPage, kResult, kTable};
  for (const auto& t : set.tests) names.push_back(curves_name(t));
  interruption_point();
  OutputFolder results(a.out, "benchmark", names, a.judging.outputs());
  const auto tested = benchmark::run_benchmark(set.tests, {.model = model,
                                                           .against = against ? &*against : nullptr,
                                                           .records = records,
                                                           .initial = set.initial,
                                                           .by = a.judging.by,
                                                           .progress = jobs::progress_line()});
  catch_stop_signals();
  const benchmark::ReportContext context{
      .model = model,
      .reference = against ? reference_name(*against, model) : "EMT records",
      .set = set,
      .by = a.judging.by,
      .provenance = provenance(a, set)};
  const std::string json = benchmark::json_report(tested, context);
  for (const auto& t : tested)
    if (t.failure.empty()) write_file(results.file(curves_name(t.test)), benchmark::csv_curves(t));
  write_file(results.file(kResult), json);
  write_file(results.file(kTable), benchmark::csv_report(tested));
  const auto page = results.file(kPage);
  write_file(page, benchmark::html_report(tested, context));
  results.finish();
  if (a.json)
    fmt::print("{}", json);
  else
    fmt::print("{}report: {}\n", benchmark::terminal_report(tested, context, a.verbose), page.string());
  a.judging.print(page);
  return benchmark::passes(tested) ? 0 : thresholds::kNotAdequate;
}

void declare(jobs::CommandLine& line, Arguments& a) {
  line.group("Input");
  line.add("--model", a.model, "plant file of the RMS model (configs/plants/README.md)").required();
  line.add(
          "--tests", a.tests,
          "tests file: kind, record, time of the event and windows of each test (configs/benchmark/README.md)")
      .required();
  line.add(
      "--records,--record", a.records,
      "records of the EMT simulation (PSCAD .inf, CSV, COMTRADE or HDF5; validate/record/README.md), each "
      "named after its test");
  line.add(
      "--against", a.against,
      "plant file of another model, whose response is the reference: to the voltage of the records, to a "
      "generated input, or behind the impedance of a grid (scr)");
  a.reading.add_columns(line);
  line.add("--user-model", a.user_model_files,
           "file (.toml) of a user-defined model that a plant may use; may be repeated")
      .one_value_a_mention();
  line.group("Output");
  line.add("--out", a.out, "folder for report.html, benchmark.json, benchmark.csv and the time series as CSV")
      .shows_default();
  a.judging.add_to(line, "dtr-simulation");
  line.add_flag("--json", a.json, "print the result as JSON instead of text");
  line.add_flag("--verbose", a.verbose, "print the errors of every channel and window");
  line.group("Expert");
  line.add("--threads", a.threads, "processor cores to use; 0: all (default)").between(0, 4096);
  line.example(
      "swingbank benchmark --model rms.toml --tests tests.toml --records emt/*.csv --out benchmarked");
  line.footer(
      "Exit codes: 0 every test is within the limits, 3 some test is not, 1 bad input, 2 interrupted.");
}

}  // namespace

int run(CommandLine& line, int argc, char** argv) {
  interrupt_on_stop_signals();
  Arguments a;
  declare(line, a);
  if (!line.parse(argc, argv)) return line.end();
  a.command = jobs::command_line("benchmark", argc, argv);
  if (a.threads > 0) omp_set_num_threads(a.threads);
  return run(a);
}

}  // namespace swingbank::jobs::benchmark_command
