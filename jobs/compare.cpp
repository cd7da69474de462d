// swingbank compare: plays records into a plant model and sets measured beside modelled P and Q.
#include <fmt/format.h>

#include <algorithm>

#include "base/json.hpp"
#include "base/output_folder.hpp"
#include "base/write_file.hpp"
#include "jobs/command_line.hpp"
#include "jobs/event_records.hpp"
#include "jobs/verdict.hpp"
#include "validate/check/record_set.hpp"
#include "validate/compare/report.hpp"
#include "validate/system/system.hpp"
#include "validate/thresholds/adequacy.hpp"

namespace {

using namespace swingbank;
using namespace swingbank::validate;

std::string joined(int argc, char** argv) {
  std::string line = "swingbank compare";
  for (int i = 1; i < argc; ++i) line += std::string(" ") + argv[i];
  return line;
}

constexpr const char *kPage = "report.html", *kResult = "compare.json",
                     *kInterrupted = "compare-interrupted.json";

struct Command {
  std::string model, system, out = "compare-report", drive = "voltage", line;
  std::vector<std::string> records;
  bool json = false;
  jobs::Reading reading;
  jobs::Judging judging;
  compare::CompareOptions options;
};

std::string playback_name(const std::string& record) {
  return "playback-" + std::filesystem::path(record).stem().string() + ".csv";
}

/// A whole grid at several terminals.
int run_system(const Command& c) {
  const system::SystemCase system = system::load_system(c.system);
  std::vector<std::string> names = {kPage, kResult, kInterrupted};
  for (const auto& terminal : system.terminals) names.push_back("curves-" + terminal.record.name + ".csv");
  OutputFolder results(c.out, "compare", names);
  const system::SystemComparison compared = system::compare_system(system);
  catch_stop_signals();  // results are written even after a stop signal
  const report::Provenance rows = system::system_provenance(system, c.line);
  const std::string result = system::system_json(system, compared, rows);
  const auto page = results.file(kPage);
  for (const auto& e : compared.terminals)
    write_file(results.file("curves-" + e.record.name + ".csv"), compare::csv_playback(e));
  write_file(results.file(kResult), result);
  write_file(page, system::system_html(system, compared, rows));
  results.finish();
  if (c.json)
    fmt::print("{}", result);
  else
    fmt::print("{}\nreport: {}\n", system::system_text(system, compared), page.string());
  return compared.adequacy.adequate ? 0 : thresholds::kNotAdequate;
}

/// The events that were compared before a signal, without a verdict.
int write_interrupted(const Command& c, OutputFolder& results, std::size_t asked,
                      const std::vector<compare::EventComparison>& events) {
  catch_stop_signals();
  const std::string sentence =
      fmt::format("Interrupted: {} of {} events were compared. Nothing is judged.", events.size(), asked);
  nlohmann::json result = {{"format", "swingbank-interrupted-1"},
                           {"interrupted", true},
                           {"command", c.line},
                           {"sentence", sentence},
                           {"events_asked", asked},
                           {"events", nlohmann::json::array()}};
  fmt::print("{}\n", sentence);
  for (const auto& e : events) {
    const auto file = results.file("interrupted-" + playback_name(e.record.name));
    write_file(file, compare::csv_playback(e));
    result["events"].push_back({{"record", e.record.name}, {"curves", file.filename().string()}});
    fmt::print("curves: {}\n", file.string());
  }
  write_file(results.file(kInterrupted), json_text(result, 1) + "\n");
  results.finish(OutputFolder::Earlier::stay);
  return kSubmitAgain;
}

int run(Command& c) {
  c.judging.read();
  compare::CompareOptions& options = c.options;
  options.drive = c.drive == "pq" ? compare::DriveBy::power : compare::DriveBy::voltage;
  plant::PlantModel model = plant::load_plant_model(c.model);
  jobs::tell(model);
  const check::Preparing preparing = c.reading.apply(model, c.records);
  Problems problems;
  auto [records, warnings] = check::read_records(c.records, model, problems, preparing);
  jobs::tell_events_elsewhere(c.records, model.reading.staged);
  problems.raise();
  interruption_point();
  std::vector<std::string> names = {kPage, kResult, kInterrupted};
  for (const auto& record : records)
    for (const std::string& name : {playback_name(record.name), "interrupted-" + playback_name(record.name)})
      if (std::ranges::count(names, name) == 0) names.push_back(name);
  OutputFolder results(c.out, "compare", names, c.judging.outputs());
  options.jumps = event::jumps_of(records, options.jump_threshold);
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
    return write_interrupted(c, results, records.size(), events);
  }
  catch_stop_signals();  // results are written even after a stop signal
  const compare::Adequacy adequacy = compare::judge(events);
  const compare::Fitness fitness = compare::judge_fitness(events, model.plant.mva, c.judging.by);
  report::Provenance rows = compare::provenance(model, events, c.line);
  jobs::sign(rows, c.judging, c.model, c.records);
  for (const auto& e : events)
    write_file(results.file(playback_name(e.record.name)), compare::csv_playback(e));
  write_file(results.file(kResult), compare::json_report(model, events, adequacy, fitness, rows));
  const auto page = results.file(kPage);
  write_file(page, compare::html_report(model, events, adequacy, fitness, rows));
  results.finish();
  if (c.json)
    fmt::print("{}", compare::json_report(model, events, adequacy, fitness, rows));
  else
    fmt::print("{}\nreport: {}\n", compare::terminal_report(model, events, adequacy, fitness), page.string());
  c.judging.print(page);
  return fitness.exit_code(adequacy.adequate);
}

}  // namespace

int main(int argc, char** argv) {
  interrupt_on_stop_signals();
  jobs::CommandLine line(SWINGBANK_SUMMARY, "swingbank compare");
  Command c;
  compare::CompareOptions& options = c.options;
  const jobs::Option model_option =
      line.add("--model", c.model, "plant file, with [[event]] for staged tests (configs/plants/README.md)");
  const jobs::Option records_option =
      line.add("--records,--record", c.records, "records (CSV, COMTRADE or HDF5), one or several");
  model_option.needs(records_option);
  records_option.needs(model_option);
  const jobs::Option system_option =
      line.add("--system", c.system,
               "instead of both: a system file, a grid with an event and records of "
               "several terminals (validate/record/README.md)")
          .excludes(model_option);
  line.add("--drive", c.drive,
           "what drives the model: voltage (V and angle; P and Q are compared) or pq (the reverse)")
      .one_of({"voltage", "pq"})
      .shows_default()
      .excludes(system_option);
  c.reading.add_switch(line).excludes(system_option);
  line.add_flag_off("--no-fit", options.fit_switchings,
                    "leave found instants in the middle of their sample interval")
      .excludes(system_option);
  line.add("--jump-threshold", options.jump_threshold,
           "smallest jump of the voltage taken for switching [pu]")
      .shows_default()
      .excludes(system_option);
  line.add("--pre-event", options.play_in.pre_event, "steady stretch of records without switching [s]")
      .shows_default()
      .excludes(system_option);
  c.reading.add_to(line);
  c.reading.add_component(line);
  c.reading.add_point(line).excludes(system_option);
  c.judging.add_to(line).excludes(system_option);
  line.add("--out", c.out, "folder for report.html, compare.json and the curves as CSV").shows_default();
  line.add_flag("--json", c.json, "print the result as JSON instead of tables");
  line.footer(thresholds::kExitCodes);
  if (!line.parse(argc, argv)) return line.end();
  if (c.model.empty() && c.system.empty()) return line.lacks("--model with --record, or --system,");
  c.line = joined(argc, argv);
  return jobs::guarded("compare", [&] { return c.system.empty() ? run(c) : run_system(c); });
}
