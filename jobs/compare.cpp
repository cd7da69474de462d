// swingbank compare: plays records into a plant model and compares measured with modelled P and Q.
#include <fmt/format.h>

#include <algorithm>

#include "base/json.hpp"
#include "base/write_file.hpp"
#include "jobs/analysis_options.hpp"
#include "validate/check/record_set.hpp"
#include "validate/compare/report.hpp"
#include "validate/system/system.hpp"
#include "validate/thresholds/adequacy.hpp"

namespace swingbank::jobs::compare_command {
namespace {

using namespace validate;

constexpr const char *kPage = "report.html", *kResult = "compare.json",
                     *kInterrupted = "compare-interrupted.json";

struct Arguments {
  jobs::AnalysisOptions of{"compare-report"};
  std::string system, input = "voltage", command;
  bool fit_switchings = true;
};

/// Returns the file names of the records' curves: the record's name without ending, or the whole name if
/// several records differ in the ending alone.
std::vector<std::string> playback_names(const std::vector<record::Record>& records) {
  const auto stem = [](const record::Record& r) { return std::filesystem::path(r.name).stem().string(); };
  std::vector<std::string> names;
  for (const auto& r : records) {
    const bool alone = std::ranges::count(records, stem(r), stem) == 1;
    names.push_back("playback-" + (alone ? stem(r) : r.name) + ".csv");
  }
  return names;
}

/// Compares a whole grid with records of several terminals.
int run_system(Arguments& a) {
  const system::SystemCase system = system::load_system(a.system);
  std::vector<std::string> names = {kPage, kResult, kInterrupted};
  for (const auto& terminal : system.terminals) names.push_back("curves-" + terminal.record.name + ".csv");
  a.of.open_results("compare", names);
  const system::SystemComparison compared = system::compare_system(system);
  OutputFolder& results = a.of.results();
  const report::Provenance rows = system::system_provenance(system, a.command);
  const std::string result = system::system_json(system, compared, rows);
  const auto page = results.file(kPage);
  for (const auto& e : compared.terminals)
    write_file(results.file("curves-" + e.record.name + ".csv"), compare::csv_playback(e));
  write_file(results.file(kResult), result);
  write_file(page, system::system_html(system, compared, rows));
  results.finish();
  if (a.of.json)
    fmt::print("{}", result);
  else
    fmt::print("{}\nreport: {}\n", system::system_text(system, compared), page.string());
  return compared.adequacy.adequate ? 0 : thresholds::kNotAdequate;
}

/// Writes the events that were compared before a stop signal, without a verdict. `curves`: file names of all
/// records.
int write_interrupted(Arguments& a, const std::vector<std::string>& curves,
                      const std::vector<compare::EventComparison>& events) {
  OutputFolder& results = a.of.results();
  const std::string sentence = fmt::format("Interrupted before a verdict: {} of {} events were compared.",
                                           events.size(), curves.size());
  nlohmann::json result = {{"format", "swingbank-interrupted-1"},
                           {"interrupted", true},
                           {"command", a.command},
                           {"sentence", sentence},
                           {"events_asked", curves.size()},
                           {"events", nlohmann::json::array()}};
  fmt::print("{}\n", sentence);
  for (std::size_t i = 0; i < events.size(); ++i) {
    const auto file = results.file("interrupted-" + curves[i]);
    write_file(file, compare::csv_playback(events[i]));
    result["events"].push_back({{"record", events[i].record.name}, {"curves", file.filename().string()}});
    fmt::print("curves: {}\n", file.string());
  }
  write_file(results.file(kInterrupted), json_text(result, 1) + "\n");
  results.finish(OutputFolder::Earlier::stay);
  return kSubmitAgain;
}

int run(Arguments& a) {
  a.of.judging.read();
  plant::PlantModel model = a.of.load_model(false);
  const check::Preparing preparing = a.of.reading.apply(model, a.of.records);
  Problems problems;
  auto [records, warnings] = check::read_records(a.of.records, model, problems, preparing);
  jobs::note_unused_events(a.of.records, model.reading.staged);
  problems.raise();
  records = a.of.compared(std::move(records));
  std::vector<std::string> names = {kPage, kResult, kInterrupted};
  const std::vector<std::string> curves = playback_names(records);
  for (const auto& name : curves) names.insert(names.end(), {name, "interrupted-" + name});
  a.of.open_results("compare", names);
  compare::CompareOptions options = a.of.comparing();
  options.input = a.input == "pq" ? compare::PlaybackInput::power : compare::PlaybackInput::voltage;
  options.fit_switchings = a.fit_switchings;
  options.step_shape = switching::step_shape_of(records, options.step_threshold);
  options.progress = jobs::progress_line();
  std::vector<compare::EventComparison> events;
  try {
    for (auto& record : records) {
      events.push_back(compare::compare_event(model, std::move(record), options));
      auto& notes = events.back().notes;
      const auto& warned = warnings[events.size() - 1];
      notes.insert(notes.begin(), warned.begin(), warned.end());
    }
  } catch (const Interrupted&) {
    if (events.empty()) throw;
    return write_interrupted(a, curves, events);
  }
  OutputFolder& results = a.of.results();
  const compare::Adequacy adequacy = compare::judge(events);
  const compare::Fitness fitness = compare::judge_fitness(events, model.plant.mva, a.of.judging.by);
  report::Provenance rows = compare::provenance(model, events, a.command);
  jobs::sign(rows, a.of.judging, a.of.model, a.of.records);
  for (std::size_t i = 0; i < events.size(); ++i)
    write_file(results.file(curves[i]), compare::csv_playback(events[i]));
  const compare::HandedIn handed = compare::handed_in(model, events);
  const std::string result = compare::json_report(model, events, adequacy, fitness, handed, rows);
  write_file(results.file(kResult), result);
  const auto page = results.file(kPage);
  write_file(page, compare::html_report(model, events, adequacy, fitness, handed, rows));
  results.finish();
  if (a.of.json)
    fmt::print("{}", result);
  else
    fmt::print("{}\nreport: {}\n",
               compare::terminal_report(model, events, adequacy, fitness, handed, a.of.verbose),
               page.string());
  a.of.judging.print(page);
  return fitness.exit_code(adequacy.adequate);
}

void declare(jobs::CommandLine& line, Arguments& a) {
  const auto of_one_plant = a.of.declare(line, "report.html, compare.json and the time series as CSV");
  line.group("Input");
  const jobs::Option system =
      line.add("--system", a.system,
               "instead of --model and --records: a system file, a grid with an event and records of "
               "several terminals (configs/systems/README.md)");
  line.group("Expert");
  line.add(
          "--playback", a.input,
          "signals of the playback: voltage (V and angle are played in, P and Q compared) or pq (the reverse)")
      .one_of({"voltage", "pq"})
      .shows_default()
      .excludes(system);
  line.add_flag_off("--no-fit", a.fit_switchings,
                    "do not fit the switching times: each is the middle of the sample interval in which it "
                    "was detected")
      .excludes(system);
  for (const jobs::Option& option : of_one_plant) option.excludes(system);
  line.example("swingbank compare --model plant.toml --records fault1.csv fault2.csv --out compared");
  line.footer(thresholds::kExitCodes);
}

}  // namespace

int run(CommandLine& line, int argc, char** argv) {
  interrupt_on_stop_signals();
  Arguments a;
  declare(line, a);
  if (!line.parse(argc, argv)) return line.end();
  if (a.of.model.empty() && a.system.empty()) return line.lacks("--model with --records, or --system,");
  a.command = jobs::command_line("compare", argc, argv);
  a.of.limit_threads();
  return a.system.empty() ? run(a) : run_system(a);
}

}  // namespace swingbank::jobs::compare_command
