// swingbank compare: plays records into a plant model and sets measured beside modelled P and Q.
#include <fmt/format.h>

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

/// A whole grid at several terminals.
int run_system(const std::string& file, const std::string& out, bool json, const std::string& command_line) {
  const system::SystemCase system = system::load_system(file);
  const system::SystemComparison c = system::compare_system(system);
  const report::Provenance rows = system::system_provenance(system, command_line);
  const std::filesystem::path folder = out;
  const std::string result = system::system_json(system, c, rows);
  for (const auto& e : c.terminals)
    write_file(folder / ("curves-" + e.record.name + ".csv"), compare::csv_playback(e));
  write_file(folder / "compare.json", result);
  write_file(folder / "report.html", system::system_html(system, c, rows));
  if (json)
    fmt::print("{}", result);
  else
    fmt::print("{}\nreport: {}\n", system::system_text(system, c), (folder / "report.html").string());
  return c.adequacy.adequate ? 0 : thresholds::kNotAdequate;
}

}  // namespace

int main(int argc, char** argv) {
  jobs::CommandLine line(SWINGBANK_SUMMARY, "swingbank compare");
  std::string model_file, system_file, out = "compare-report", drive = "voltage";
  std::vector<std::string> record_files;
  bool json = false;
  jobs::Reading reading;
  jobs::Judging judging;
  compare::CompareOptions options;
  const jobs::Option model_option = line.add(
      "--model", model_file, "plant file, with [[event]] for staged tests (configs/plants/README.md)");
  const jobs::Option records_option =
      line.add("--records,--record", record_files, "records (CSV, COMTRADE or HDF5), one or several");
  model_option.needs(records_option);
  records_option.needs(model_option);
  const jobs::Option system_option =
      line.add("--system", system_file,
               "instead of both: a system file, a grid with an event and records of "
               "several terminals (validate/record/README.md)")
          .excludes(model_option);
  line.add("--drive", drive,
           "what drives the model: voltage (V and angle; P and Q are compared) or pq (the reverse)")
      .one_of({"voltage", "pq"})
      .shows_default()
      .excludes(system_option);
  reading.add_switch(line).excludes(system_option);
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
  reading.add_to(line);
  reading.add_component(line);
  reading.add_point(line).excludes(system_option);
  judging.add_to(line).excludes(system_option);
  line.add("--out", out, "folder for report.html, compare.json and the curves as CSV").shows_default();
  line.add_flag("--json", json, "print the result as JSON instead of tables");
  line.footer(thresholds::kExitCodes);
  if (!line.parse(argc, argv)) return line.end();
  if (model_file.empty() && system_file.empty()) return line.lacks("--model with --record, or --system,");
  try {
    if (!system_file.empty()) return run_system(system_file, out, json, joined(argc, argv));
    judging.read();
    options.drive = drive == "pq" ? compare::DriveBy::power : compare::DriveBy::voltage;
    plant::PlantModel model = plant::load_plant_model(model_file);
    jobs::tell(model);
    const check::Preparing preparing = reading.apply(model, record_files);
    Problems problems;
    auto [records, warnings] = check::read_records(record_files, model, problems, preparing);
    jobs::tell_events_elsewhere(record_files, model.reading.staged);
    problems.raise();
    options.jumps = event::jumps_of(records, options.jump_threshold);
    options.progress = jobs::progress_line();
    std::vector<compare::EventComparison> events;
    for (auto& record : records) {
      events.push_back(compare::compare_event(model, std::move(record), options));
      auto& notes = events.back().notes;
      const auto& warned = warnings[events.size() - 1];
      notes.insert(notes.begin(), warned.begin(), warned.end());
    }
    const compare::Adequacy adequacy = compare::judge(events);
    const compare::Fitness fitness = compare::judge_fitness(events, model.plant.mva, judging.by);
    report::Provenance rows = compare::provenance(model, events, joined(argc, argv));
    jobs::sign(rows, judging, model_file, record_files);
    const std::filesystem::path folder = out;
    for (const auto& e : events)
      write_file(folder / ("playback-" + std::filesystem::path(e.record.name).stem().string() + ".csv"),
                 compare::csv_playback(e));
    write_file(folder / "compare.json", compare::json_report(model, events, adequacy, fitness, rows));
    write_file(folder / "report.html", compare::html_report(model, events, adequacy, fitness, rows));
    if (json)
      fmt::print("{}", compare::json_report(model, events, adequacy, fitness, rows));
    else
      fmt::print("{}\nreport: {}\n", compare::terminal_report(model, events, adequacy, fitness),
                 (folder / "report.html").string());
    judging.print(folder / "report.html");
    return fitness.exit_code(adequacy.adequate);
  } catch (const InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "swingbank compare: {}\n", error.what());
    return 1;
  }
}
